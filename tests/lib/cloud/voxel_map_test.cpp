// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/voxel_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/clouds.hpp"

namespace dseam::cloud {
namespace {

using test::Family;
using test::OwnedCloud;

class VoxelMapTest : public ::testing::Test {
 protected:
  VoxelMap make(float cell_mm, std::size_t max_cells = 20000) {
    return VoxelMap::make({.cell_mm = cell_mm}, max_cells, memory_.arena()).value();
  }

  test::ArenaOwner memory_{4 * VoxelMap::bytes(20000)};
};

TEST_F(VoxelMapTest, refuses_cells_without_size_and_too_little_memory) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  test::ArenaOwner little(1000);

  EXPECT_FALSE(VoxelMap::make({.cell_mm = 0.0F}, 10, memory_.arena()).ok());
  EXPECT_FALSE(VoxelMap::make({.cell_mm = nan}, 10, memory_.arena()).ok());
  EXPECT_FALSE(VoxelMap::make({.origin_mm = {nan, 0.0F, 0.0F}}, 10, memory_.arena()).ok());
  EXPECT_EQ(VoxelMap::make({}, 1000, little.arena()).error(), Errc::kOutOfMemory);
}

TEST_F(VoxelMapTest, points_of_one_cell_become_their_centroid_in_first_insertion_order) {
  VoxelMap map = make(1.0F);
  OwnedCloud cloud;
  cloud.add(0.25F, 0.0F, 0.0F);
  cloud.add(-0.5F, 0.0F, 0.0F);
  cloud.add(0.75F, 0.5F, 0.0F);

  const auto report = map.insert(cloud.view(), 0);

  EXPECT_EQ(report.inserted, 3U);
  const FusedCloudView view = map.view();
  ASSERT_EQ(view.points.size(), 2U);
  EXPECT_EQ(view.points[0], (geometry::Vec3f{0.5F, 0.25F, 0.0F}));
  EXPECT_EQ(view.points[1], (geometry::Vec3f{-0.5F, 0.0F, 0.0F}));
  EXPECT_EQ(view.count[0], 2U);
}

TEST_F(VoxelMapTest, a_cell_knows_the_views_that_saw_it) {
  VoxelMap map = make(1.0F);
  OwnedCloud here;
  here.add(0.5F, 0.5F, 0.5F);
  OwnedCloud there = here;
  there.add(5.5F, 0.5F, 0.5F);

  map.insert(here.view(), 3);
  map.insert(there.view(), 15);

  const FusedCloudView view = map.view();
  EXPECT_EQ(view.seen_by[0], (1U << 3U) | (1U << 15U));
  EXPECT_EQ(view.seen_by[1], 1U << 15U);
}

TEST_F(VoxelMapTest, what_is_out_of_range_or_finds_no_room_is_counted) {
  VoxelMap map = make(1.0F, 2);
  OwnedCloud cloud;
  for (const float x : {0.5F, 1.5F, 2.5F, 1.25F, 2.0e6F, -1048576.0F}) {
    cloud.add(x, 0.0F, 0.0F);
  }
  cloud.add(0.0F, std::numeric_limits<float>::quiet_NaN(), 0.0F);
  cloud.add(0.0F, 0.0F, -std::numeric_limits<float>::infinity());

  const auto report = map.insert(cloud.view(), 0);

  EXPECT_EQ(report.inserted, 3U);
  EXPECT_EQ(report.dropped_full, 1U);
  EXPECT_EQ(report.dropped_out_of_range, 4U);
  EXPECT_EQ(map.view().count[1], 2U);
}

TEST_F(VoxelMapTest, a_million_points_in_one_cell_lose_nothing) {
  VoxelMap map = make(1.0F);
  const std::vector<float> x(1000000, 100.3F);

  map.insert({x, x, x}, 0);

  EXPECT_NEAR(map.view().points.x[0], 100.3F, 1e-5F);
  EXPECT_EQ(map.view().count[0], 1000000U);
}

TEST_F(VoxelMapTest, centroids_do_not_depend_on_the_order_of_the_points) {
  OwnedCloud cloud = test::make_cloud(Family::kSurface, 5000, 1);
  OwnedCloud reversed = cloud;
  for (auto* axis : {&reversed.x, &reversed.y, &reversed.z}) {
    std::reverse(axis->begin(), axis->end());
  }
  VoxelMap one = make(3.0F);
  VoxelMap other = make(3.0F);

  one.insert(cloud.view(), 0);
  other.insert(reversed.view(), 0);

  const CloudView points = one.view().points;
  const CloudView others = other.view().points;
  ASSERT_EQ(points.size(), others.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i], others[other.find(points[i])]);
  }
}

TEST_F(VoxelMapTest, clear_and_another_lattice_empty_it_and_nothing_allocates) {
  VoxelMap map = make(1.0F);
  const OwnedCloud cloud = test::make_cloud(Family::kSurface, 1000, 1);
  const test::AllocationCounter allocations;
  map.insert(cloud.view(), 0);
  map.clear();
  EXPECT_EQ(map.size(), 0U);
  map.insert(cloud.view(), 0);

  const std::size_t before = map.size();
  map.relay(2.0F, {0.5F, 0.5F, 0.5F});

  EXPECT_EQ(map.size(), 0U);
  map.insert(cloud.view(), 0);
  EXPECT_GT(map.size(), 0U);
  EXPECT_LT(map.size(), before);
  EXPECT_EQ(allocations.count(), 0U);
}

/// The textbook answer: which cell by the same float arithmetic, the centroid in double.
class VoxelOracle : public ::testing::TestWithParam<int> {
 protected:
  struct Truth {
    std::array<double, 3> sum{};
    std::uint32_t count = 0;
    std::size_t order = 0;
  };
  using Cells = std::map<std::array<float, 3>, Truth>;

  static Cells by_brute_force(const OwnedCloud& cloud, float cell_mm) {
    Cells cells;
    const float scale = 1.0F / cell_mm;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const std::array<float, 3> p{cloud.x[i], cloud.y[i], cloud.z[i]};
      std::array<float, 3> cell{};
      bool usable = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        cell[axis] = std::floor(p[axis] * scale);
        usable = usable && std::fabs(p[axis] * scale) < 1048576.0F;
      }
      if (usable) {
        const std::size_t order = cells.size();
        Truth& truth = cells.try_emplace(cell, Truth{{}, 0, order}).first->second;
        ++truth.count;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          truth.sum[axis] += static_cast<double>(p[axis]);
        }
      }
    }
    return cells;
  }
};

TEST_P(VoxelOracle, cells_are_the_textbook_ones) {
  const auto family = static_cast<Family>(GetParam());
  test::ArenaOwner memory(VoxelMap::bytes(3000));
  VoxelMap map = VoxelMap::make({.cell_mm = 1.5F}, 3000, memory.arena()).value();
  for (std::uint64_t seed = 0; seed < 30 && !HasFailure(); ++seed) {
    const OwnedCloud cloud = test::make_cloud(family, 37 * (seed + 1), seed);
    map.clear();

    map.insert(cloud.view(), 0);

    const FusedCloudView view = map.view();
    const Cells truth = by_brute_force(cloud, 1.5F);
    ASSERT_EQ(view.points.size(), truth.size());
    for (const auto& [cell, one] : truth) {
      const double count = one.count;
      const geometry::Vec3f p = view.points[one.order];
      EXPECT_EQ(view.count[one.order], one.count);
      const double tolerance =
          1e-5 +
          1e-6 * (std::fabs(one.sum[0]) + std::fabs(one.sum[1]) + std::fabs(one.sum[2])) / count;
      EXPECT_NEAR(p.x, one.sum[0] / count, tolerance);
      EXPECT_NEAR(p.y, one.sum[1] / count, tolerance);
      EXPECT_NEAR(p.z, one.sum[2] / count, tolerance);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, VoxelOracle, ::testing::Range(0, test::kNumFamilies),
                         [](const auto& family) {
                           return std::string(test::name(static_cast<Family>(family.param)));
                         });

}  // namespace
}  // namespace dseam::cloud
