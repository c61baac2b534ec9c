// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/voxel_downsample.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/clouds.hpp"

namespace dseam::cloud {
namespace {

using test::OwnedCloud;

class VoxelDownsampleTest : public ::testing::Test {
 protected:
  VoxelDownsample make(const VoxelDownsample::Config& config, std::size_t max_cells = 100) {
    return VoxelDownsample::make(config, max_cells, memory_.arena()).value();
  }

  test::ArenaOwner memory_{4 * VoxelDownsample::bytes(3000) + 2 * CloudBuffer::bytes(3000)};
  CloudBuffer out_{3000, memory_.arena()};
  std::vector<std::uint32_t> storage_ = std::vector<std::uint32_t>(3000);
  Buffer<std::uint32_t> kept_{storage_};
};

OwnedCloud on_a_line(std::initializer_list<float> places) {
  OwnedCloud cloud;
  for (const float x : places) {
    cloud.add(x, 0.0F, 0.0F);
  }
  return cloud;
}

TEST_F(VoxelDownsampleTest, the_lattice_lies_at_the_origin_or_at_the_minimum_corner) {
  const OwnedCloud cloud = on_a_line({2.5F, 3.5F, 4.5F});
  auto origin = make({.cell_mm = 3.0F});
  auto corner = make({.cell_mm = 3.0F, .lattice = VoxelDownsample::Lattice::kMinimumCorner});

  EXPECT_EQ(origin.run(cloud.view(), out_).cells, 2U);
  EXPECT_NEAR(out_[1].x, 4.0F, 1e-5F);
  EXPECT_EQ(corner.run(cloud.view(), out_).cells, 1U);
  EXPECT_NEAR(out_[0].x, 3.5F, 1e-5F);
}

TEST_F(VoxelDownsampleTest, the_nearest_point_to_the_centroid_can_stand_for_the_cell) {
  const OwnedCloud cloud = on_a_line({0.0F, 0.5F, 2.5F});
  auto stage =
      make({.cell_mm = 3.0F, .representative = VoxelDownsample::Representative::kNearestPoint});

  stage.run(cloud.view(), out_, kept_);

  ASSERT_EQ(kept_.size(), 1U);
  EXPECT_EQ(kept_[0], 1U);
  EXPECT_EQ(out_[0].x, 0.5F);
}

TEST_F(VoxelDownsampleTest, kept_names_the_point_nearest_to_each_centroid) {
  const OwnedCloud cloud = test::make_cloud(test::Family::kSurface, 3000, 1);
  auto stage = make({}, 3000);

  const auto report = stage.run(cloud.view(), out_, kept_);

  ASSERT_EQ(kept_.size(), report.cells);
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    EXPECT_LT(geometry::norm(cloud.view()[kept_[i]] - out_[i]), 3.0F);
  }
}

TEST_F(VoxelDownsampleTest, what_finds_no_room_and_what_is_no_point_are_counted) {
  OwnedCloud cloud = on_a_line({0.0F, 10.0F, 20.0F, 30.0F});
  cloud.add(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
  auto stage = make({}, 3);
  std::vector<float> room(2);
  CloudBuffer two(room, room, room);

  const auto report = stage.run(cloud.view(), two);

  EXPECT_EQ(report.cells, 3U);
  EXPECT_EQ(report.cells_cut, 1U);
  EXPECT_EQ(report.dropped_full, 1U);
  EXPECT_EQ(report.dropped_out_of_range, 1U);
}

TEST_F(VoxelDownsampleTest, a_cloud_without_points_is_an_empty_one_and_nothing_allocates) {
  auto stage = make({.lattice = VoxelDownsample::Lattice::kMinimumCorner});
  const test::AllocationCounter allocations;

  EXPECT_EQ(stage.run({}, out_, kept_).cells, 0U);

  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace dseam::cloud
