// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/cloud_splice_chain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "dseam/base/random.hpp"
#include "pipe_on_plate.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/measured_data.hpp"

namespace dseam::pipeline {
namespace {

using geometry::RigidTransform;
using splice::ViewState;
using test::OwnedCloud;

struct Spliced {
  std::size_t placed = 0;
  std::vector<splice::SplicedView> views;
  std::vector<CloudSpliceRow> rows;
};

Spliced splice_all(const std::vector<OwnedCloud>& clouds) {
  const CloudSpliceChain::Capacity capacity;
  test::ArenaOwner owner(CloudSpliceChain::bytes(capacity));
  auto chain = CloudSpliceChain::make({}, capacity, owner.arena());
  std::vector<cloud::CloudView> in;
  for (const OwnedCloud& cloud : clouds) {
    in.push_back(cloud.view());
  }
  std::vector<splice::SplicedView> storage(clouds.size());
  Buffer<splice::SplicedView> out(storage);

  const test::AllocationCounter allocations;
  Spliced spliced{chain.value().run(in, out), {}, {}};
  EXPECT_EQ(allocations.count(), 0U);

  spliced.views = storage;
  spliced.rows.assign(chain.value().rows().begin(), chain.value().rows().end());
  return spliced;
}

/// A pipe of radius 40 beside a wall on a plate, in part coordinates, as seen from azimuth `from`.
struct Part {
  Pcg32 random{7};
  double noise_mm = 0.2;

  double jitter() {
    return noise_mm * (random.uniform() + random.uniform() + random.uniform() - 1.5) * 2.0;
  }
  void pipe(double from_rad, double length_mm, const RigidTransform& T, OwnedCloud& out) {
    for (int i = 0; i < 6000; ++i) {
      const double phi = from_rad + (random.uniform() - 0.5) * 0.9 * std::numbers::pi;
      const double r = 40.0 + jitter();
      out.add(T *
              Eigen::Vector3d(r * std::cos(phi), r * std::sin(phi), length_mm * random.uniform()));
    }
  }
  void plate_and_wall(const RigidTransform& T, OwnedCloud& out) {
    for (int i = 0; i < 6000; ++i) {
      const Eigen::Vector2d p(-90.0 + 200.0 * random.uniform(), -80.0 + 140.0 * random.uniform());
      if (p.norm() > 40.0) {
        out.add(T * Eigen::Vector3d(p.x(), p.y(), jitter()));
      }
      out.add(T * Eigen::Vector3d(p.x(), 60.0 + jitter(), 45.0 * random.uniform()));
    }
  }
};

RigidTransform anywhere() {
  return {geometry::rotation_exp({0.9, -1.4, 0.7}), {300.0, -120.0, 640.0}};
}

TEST(CloudSpliceChain, a_cloud_that_lies_anywhere_is_brought_back) {
  Part part;
  const RigidTransform T_second = anywhere();
  std::vector<OwnedCloud> clouds(2);
  part.pipe(0.0, 90.0, {}, clouds[0]);
  part.plate_and_wall({}, clouds[0]);
  part.pipe(0.6, 90.0, T_second, clouds[1]);
  part.plate_and_wall(T_second, clouds[1]);

  const Spliced spliced = splice_all(clouds);

  ASSERT_EQ(spliced.placed, 2U);
  const RigidTransform error = spliced.views[1].T_base_camera * T_second;
  EXPECT_LT((error * Eigen::Vector3d(40.0, 0.0, 0.0) - Eigen::Vector3d(40.0, 0.0, 0.0)).norm(),
            0.3);
}

TEST(CloudSpliceChain, a_bare_pipe_fits_in_many_places_and_is_not_placed_in_one_of_them) {
  Part part;
  std::vector<OwnedCloud> clouds(2);
  part.pipe(0.0, 90.0, {}, clouds[0]);
  part.pipe(0.0, 90.0, anywhere(), clouds[1]);

  const Spliced spliced = splice_all(clouds);

  EXPECT_EQ(spliced.views[1].state, ViewState::kAmbiguous);
  EXPECT_EQ(spliced.placed, 1U);
}

TEST(CloudSpliceChain, empty_clouds_and_those_of_another_shape_are_named) {
  Part part;
  std::vector<OwnedCloud> clouds(3);
  part.pipe(0.0, 90.0, {}, clouds[0]);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d p(part.random.uniform(), part.random.uniform(), part.random.uniform());
    clouds[2].add(80.0 * p);
  }

  const Spliced spliced = splice_all(clouds);

  EXPECT_EQ(spliced.views[1].state, ViewState::kEmpty);
  EXPECT_EQ(spliced.views[2].state, ViewState::kNoOverlap);
}

double median_distance_mm(const std::vector<OwnedCloud>& clouds, const Spliced& spliced) {
  const test::MeshSamples mesh = test::mesh_samples(0.8);
  test::ArenaOwner owner(search::GridIndex::bytes(mesh.points.x.size()));
  auto index = search::GridIndex::make(mesh.points.x.size(), owner.arena());
  (void)index.value().rebuild(mesh.points.view());
  OwnedCloud merged;
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    for (std::size_t k = 0; k < clouds[i].x.size(); ++k) {
      merged.add(spliced.views[i].T_base_camera *
                 Eigen::Vector3d(clouds[i].x[k], clouds[i].y[k], clouds[i].z[k]));
    }
  }
  splice::Icp::Config config;
  config.start_gate_mm = 20.0;
  config.final_gate_mm = 4.0;
  const cloud::NormalsView normals{mesh.normals.x, mesh.normals.y, mesh.normals.z, {}};
  const auto icp = splice::Icp(config).run(merged.view(), mesh.points.view(), normals,
                                           index.value(), RigidTransform{});
  std::vector<double> distances;
  for (std::size_t i = 0; i < merged.x.size(); ++i) {
    const Eigen::Vector3f p =
        (icp.T_target_source * Eigen::Vector3d(merged.x[i], merged.y[i], merged.z[i]))
            .cast<float>();
    distances.push_back(std::sqrt(index.value().nearest({p.x(), p.y(), p.z()}).squared_mm2));
  }
  std::sort(distances.begin(), distances.end());
  return distances[distances.size() / 2];
}

using MeasuredClouds = test::MeasuredData;

// The file of 45 degrees comes first: its frame is about that of the mesh.
TEST_F(MeasuredClouds, four_measured_scans_of_a_pipe_on_a_plate_lie_on_its_mesh) {
  std::vector<OwnedCloud> clouds;
  for (const char* file : {"shape1_45deg_filtered_aligned.pcd", "shape1_0deg_filtered.pcd",
                           "shape1_60deg_filtered.pcd", "shape1_90deg_filtered.pcd"}) {
    clouds.push_back(test::measured_scan(file));
  }

  const Spliced spliced = splice_all(clouds);

  ASSERT_EQ(spliced.placed, 4U);
  EXPECT_LE(median_distance_mm(clouds, spliced), 1.25);
}

}  // namespace
}  // namespace dseam::pipeline
