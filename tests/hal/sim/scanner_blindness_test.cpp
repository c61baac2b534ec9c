// SPDX-License-Identifier: Apache-2.0
// Where the scanner sees nothing: dead band, unseen stretch, discs, glints, shadows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "clean_cell.hpp"

namespace dseam::hal::sim {
namespace {

double distance_to(const TruthCurve& curve, const Eigen::Vector3d& p) {
  double nearest = 1e9;
  for (const TruthPoint& point : curve.points) {
    nearest = std::min(nearest, (point.p - p).norm());
  }
  return nearest;
}

struct NearSeam {
  std::size_t inside = 0;  ///< Measured pixels within 2 mm of the seam...
  std::size_t around = 0;  ///< ...and from there to 4 mm.
};

NearSeam measured_near_seam(const CellConfig& config) {
  const Cell cell = Cell::make(config).value();
  const TruthCurve truth = *cell.seam();
  const depth::Intrinsics k = intrinsics(config.scanner);
  Rendering r;
  NearSeam near;
  for (std::size_t view = 0; view < 6; ++view) {
    cell.scan(view, r);
    for (std::size_t i = 0; i < r.depth.size(); i += 7) {
      const double z = static_cast<double>(r.true_z_mm[i]);
      const double x = (static_cast<double>(i % k.width) - k.cx) * z / k.fx;
      const double y = (static_cast<double>(i / k.width) - k.cy) * z / k.fy;
      if (r.depth[i] == 0) {
        continue;
      }
      const double d =
          distance_to(truth, cell.views()[view].T_base_camera * Eigen::Vector3d(x, y, z));
      near.inside += d < 1.95;
      near.around += d > 2.05 && d < 4.0;
    }
  }
  return near;
}

TEST(Scanner, a_dead_band_takes_away_what_is_within_half_its_width_of_the_joint) {
  CellConfig config = clean_cell();
  config.scanner.width = 324;
  config.scanner.height = 242;
  const NearSeam before = measured_near_seam(config);
  config.scanner.dead_band_mm = 4.0;

  const NearSeam after = measured_near_seam(config);

  EXPECT_GT(before.inside, 100U);
  EXPECT_EQ(after.inside, 0U);
  EXPECT_EQ(after.around, before.around);
}

TEST(Scanner, the_unseen_stretch_of_the_ring_is_measured_by_no_view) {
  CellConfig config = clean_cell();
  config.scanner.width = 324;
  config.scanner.height = 242;
  config.scanner.unseen_share = 0.15;
  config.scanner.unseen_start = 0.4;
  const Cell cell = Cell::make(config).value();
  const TruthCurve truth = *cell.seam();
  const depth::Intrinsics k = intrinsics(config.scanner);
  const std::size_t num_bins = truth.points.size();
  std::vector<int> seen(num_bins, 0);
  Rendering r;
  for (std::size_t view = 0; view < 6; ++view) {
    cell.scan(view, r);
    for (std::size_t i = 0; i < r.depth.size(); ++i) {
      const double z = static_cast<double>(r.true_z_mm[i]);
      const Eigen::Vector3d p_camera((static_cast<double>(i % k.width) - k.cx) * z / k.fx,
                                     (static_cast<double>(i / k.width) - k.cy) * z / k.fy, z);
      const Eigen::Vector3d p = cell.views()[view].T_base_camera * p_camera;
      for (std::size_t bin = 0; r.depth[i] != 0 && bin < num_bins; bin += 8) {
        seen[bin] += (truth.points[bin].p - p).squaredNorm() < 4.0;
      }
    }
  }
  for (std::size_t bin = 0; bin < num_bins; bin += 8) {
    const double share = static_cast<double>(bin) / static_cast<double>(num_bins);
    const bool surely_unseen = share > 0.41 && share < 0.54;
    const bool surely_seen = share < 0.39 || share > 0.56;

    EXPECT_TRUE(!surely_unseen || seen[bin] == 0) << share;
    EXPECT_TRUE(!surely_seen || seen[bin] > 0) << share;
  }
}

TEST(Scanner, discs_can_be_without_depth) {
  CellConfig config = clean_cell();
  const Rendering with = scan(config);
  config.markers.depth_on_disc = false;
  const Rendering without = scan(config);

  std::size_t lost = 0;
  for (std::size_t i = 0; i < with.depth.size(); ++i) {
    lost += with.depth[i] != 0 && without.depth[i] == 0;
    EXPECT_TRUE(without.depth[i] == 0 || without.depth[i] == with.depth[i]);
  }
  // A dozen discs or so of 6 mm are seen at about 0.6 mm a pixel.
  EXPECT_GT(lost, 200U);
  EXPECT_LT(lost, 1500U);
}

TEST(Scanner, glints_are_saturated_and_without_depth) {
  CellConfig config = clean_cell();
  const Rendering before = scan(config);
  config.scanner.num_specular_spots = 10;
  const Rendering after = scan(config);

  std::size_t saturated = 0;
  for (std::size_t i = 0; i < after.depth.size(); ++i) {
    if (after.depth[i] != before.depth[i]) {
      ++saturated;
      EXPECT_EQ(after.depth[i], 0);
      EXPECT_GT(after.gray[i], 128);
    }
  }
  EXPECT_GT(saturated, 50U);
}

TEST(Scanner, a_projector_beside_the_lens_throws_shadows_behind_edges_only) {
  CellConfig config = clean_cell();
  const Rendering before = scan(config);
  config.scanner.projector_baseline_mm = 150.0;
  const Rendering after = scan(config);
  CellConfig plate = config;
  plate.joint.kind = JointKind::kShellOnly;
  plate.joint.shell = ShellKind::kPlane;
  plate.joint.shell_length_mm = 1000.0;
  const Rendering flat = scan(plate);

  std::size_t shadowed = 0;
  for (std::size_t i = 0; i < before.depth.size(); ++i) {
    shadowed += before.depth[i] != 0 && after.depth[i] == 0;
    EXPECT_TRUE(after.depth[i] == 0 || after.depth[i] == before.depth[i]);
  }
  EXPECT_GT(shadowed, 500U);
  EXPECT_EQ(std::ranges::count(flat.depth, 0), 0);
}

}  // namespace
}  // namespace dseam::hal::sim
