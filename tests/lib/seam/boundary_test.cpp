// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/boundary.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "dseam/cloud/normals.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/clouds.hpp"

namespace dseam::seam {
namespace {

using geometry::Vec3f;
using search::GridIndex;
using test::Family;
using test::OwnedCloud;

constexpr std::size_t kMostPoints = 1000;
constexpr double kTurn = 2.0 * std::numbers::pi;

class BoundaryTestTest : public ::testing::TestWithParam<int> {
 protected:
  BoundaryTestTest() : index_(GridIndex::make(kMostPoints, memory_.arena()).value()) {}

  BoundaryTest::Report run(const OwnedCloud& cloud, const BoundaryTest::Config& config) {
    index_.rebuild(cloud.view());
    const auto normals = cloud::NormalEstimation::make({.radius_mm = config.radius_mm}).value();
    normals.run(index_, {cloud.view(), {}, {}}, {}, normals_);
    auto stage = BoundaryTest::make(config, memory_.arena()).value();
    const test::AllocationCounter allocations;
    const auto report = stage.run(index_, normals_.view(cloud.size()), out_, found_);
    EXPECT_EQ(allocations.count(), 0U);
    return report;
  }

  test::ArenaOwner memory_{GridIndex::bytes(kMostPoints) + BoundaryBuffer::bytes(kMostPoints) +
                           cloud::NormalsBuffer::bytes(kMostPoints) + 30 * BoundaryTest::bytes()};
  GridIndex index_;
  cloud::NormalsBuffer normals_{kMostPoints, memory_.arena()};
  BoundaryBuffer out_{kMostPoints, memory_.arena()};
  std::vector<std::uint32_t> storage_ = std::vector<std::uint32_t>(kMostPoints);
  Buffer<std::uint32_t> found_{storage_};
};

OwnedCloud square_sheet() {
  OwnedCloud cloud;
  for (int i = 0; i < 400; ++i) {
    cloud.add(static_cast<float>(i % 20), static_cast<float>(i / 20), 5.0F);
  }
  return cloud;
}

TEST_F(BoundaryTestTest, the_rim_of_a_sheet_is_found_and_its_open_side_points_outward) {
  const auto report = run(square_sheet(), {.radius_mm = 2.5F});

  EXPECT_EQ(report.boundary, 76U);
  EXPECT_EQ(report.inner, 324U);
  for (const std::uint32_t i : found_.view()) {
    EXPECT_TRUE(i % 20 == 0 || i % 20 == 19 || i / 20 == 0 || i / 20 == 19);
  }
  EXPECT_NEAR(out_.gap_rad[10], std::numbers::pi_v<float>, 1e-5F);  // Bottom edge,
  EXPECT_NEAR(out_.open_y[10], -1.0F, 1e-5F);
  EXPECT_NEAR(out_.gap_rad[0], 1.5F * std::numbers::pi_v<float>, 1e-5F);  // corner.
  EXPECT_NEAR(out_.open_x[0], -std::sqrt(0.5F), 1e-5F);
  EXPECT_NEAR(out_.open_y[0], -std::sqrt(0.5F), 1e-5F);
}

TEST_F(BoundaryTestTest, points_without_normal_or_neighbours_are_no_boundary) {
  OwnedCloud cloud;
  for (int i = 0; i < 20; ++i) {
    cloud.add(static_cast<float>(i), 0.0F, 0.0F);  // A line has no normal.
  }
  cloud.add(100.0F, 0.0F, 0.0F);
  cloud.add(NAN, 0.0F, 0.0F);

  const auto report = run(cloud, {.radius_mm = 2.5F});

  EXPECT_EQ(report.without_normal, 22U);
  EXPECT_EQ(report.boundary, 0U);
  EXPECT_EQ(out_.gap_rad[21], 0.0F);
}

TEST_F(BoundaryTestTest, refuses_what_makes_no_sense_and_counts_what_finds_no_room) {
  EXPECT_FALSE(BoundaryTest::make({.radius_mm = NAN}, memory_.arena()).ok());
  EXPECT_FALSE(BoundaryTest::make({.min_gap_rad = 0.0F}, memory_.arena()).ok());
  found_ = Buffer<std::uint32_t>(std::span(storage_).first(10));

  const auto report = run(square_sheet(), {.radius_mm = 2.5F});

  EXPECT_EQ(report.boundary, 76U);
  EXPECT_EQ(report.dropped_full, 66U);
}

// The largest gap by arc tangents and a sort, in double.
double gap_by_brute_force(const OwnedCloud& cloud, std::size_t i, Vec3f n, float radius_mm) {
  const Eigen::Vector3d normal(static_cast<double>(n.x), static_cast<double>(n.y),
                               static_cast<double>(n.z));
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.cross(u);
  std::vector<double> turns;
  for (std::size_t j = 0; j < cloud.size(); ++j) {
    const Vec3f off = cloud.view()[j] - cloud.view()[i];
    const Eigen::Vector3d d(static_cast<double>(off.x), static_cast<double>(off.y),
                            static_cast<double>(off.z));
    // Straight along the normal there is no direction in the plane.
    const bool has_direction = normal.cross(d).norm() > 1e-4 * d.norm();
    if (geometry::squared_norm(off) <= radius_mm * radius_mm && has_direction) {
      turns.push_back(std::atan2(v.dot(d), u.dot(d)));
    }
  }
  std::sort(turns.begin(), turns.end());
  double gap = turns.empty() ? kTurn : turns.front() + kTurn - turns.back();
  for (std::size_t j = 1; j < turns.size(); ++j) {
    gap = std::max(gap, turns[j] - turns[j - 1]);
  }
  return gap;
}

bool is_asked_of(const OwnedCloud& cloud, std::size_t i, Vec3f normal, float radius_mm) {
  std::uint32_t others = 0;
  for (std::size_t j = 0; j < cloud.size(); ++j) {
    const Vec3f off = cloud.view()[j] - cloud.view()[i];
    others += j != i && geometry::squared_norm(off) <= radius_mm * radius_mm ? 1U : 0U;
  }
  return normal != Vec3f{} && others >= BoundaryTest::Config{}.min_neighbours;
}

TEST_P(BoundaryTestTest, gaps_are_those_of_arc_tangents_and_a_sort) {
  const auto family = static_cast<Family>(GetParam());
  std::size_t compared = 0;
  for (std::uint64_t seed = 0; seed < 12 && !HasFailure(); ++seed) {
    const OwnedCloud cloud = test::make_cloud(family, 40 + 60 * seed, seed);
    run(cloud, {.radius_mm = 2.0F});
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double truth = gap_by_brute_force(cloud, i, normals_[i], 2.0F);
      if (is_asked_of(cloud, i, normals_[i], 2.0F) &&
          truth > 2.0 * kTurn / BoundaryTest::kSectors) {
        // The rounding of the normal weighs more on neighbours nearly along it.
        const bool steep = family == Family::kVolume || family == Family::kLattice ||
                           family == Family::kHalfOutliers || family == Family::kCellFaces;
        EXPECT_NEAR(out_.gap_rad[i], truth, steep ? 2e-2 : 2e-4) << i;
        ++compared;
      }
    }
  }
  const bool has_surface = family == Family::kSurface || family == Family::kCoplanar;
  EXPECT_TRUE(!has_surface || compared > 1000);
}

INSTANTIATE_TEST_SUITE_P(Families, BoundaryTestTest, ::testing::Range(0, test::kNumFamilies),
                         [](const auto& family) {
                           return std::string(test::name(static_cast<Family>(family.param)));
                         });

}  // namespace
}  // namespace dseam::seam
