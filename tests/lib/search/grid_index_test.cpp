// SPDX-License-Identifier: Apache-2.0
#include "dseam/search/grid_index.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/clouds.hpp"

namespace dseam::search {
namespace {

using test::Family;

class GridIndexTest : public ::testing::Test {
 protected:
  GridIndex make(std::size_t max_points) { return GridIndex::make(max_points, arena()).value(); }
  Arena& arena() { return memory_.arena(); }

  test::ArenaOwner memory_{GridIndex::bytes(5000)};
};

TEST_F(GridIndexTest, refuses_no_points_and_too_little_memory) {
  test::ArenaOwner little(GridIndex::bytes(100) / 2);

  EXPECT_EQ(GridIndex::make(0, arena()).error(), Errc::kInvalidArgument);
  EXPECT_EQ(GridIndex::make(100, little.arena()).error(), Errc::kOutOfMemory);
}

TEST_F(GridIndexTest, an_index_without_points_finds_none) {
  GridIndex index = make(10);
  std::vector<Neighbour> found(3);

  index.rebuild({});

  EXPECT_EQ(index.nearest({}).index, kNoPoint);
  EXPECT_EQ(index.k_nearest({}, found), 0U);
  EXPECT_EQ(index.radius({}, 1.0F, found), 0U);
  index.k_nearest_of_all(3, {});
  index.mean_distances(3, {});
}

TEST_F(GridIndexTest, what_is_not_finite_or_too_far_is_counted_and_never_found) {
  GridIndex index = make(10);
  test::OwnedCloud cloud;
  cloud.add(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
  cloud.add(0.0F, std::numeric_limits<float>::infinity(), 0.0F);
  cloud.add(0.0F, 0.0F, -2.0F * GridIndex::kMaxMm);
  cloud.add(1.0F, 2.0F, 3.0F);

  const auto report = index.rebuild(cloud.view());

  EXPECT_EQ(report.num_indexed, 1U);
  EXPECT_EQ(report.dropped_out_of_range, 3U);
  EXPECT_EQ(index.nearest({}).index, 3U);
}

TEST_F(GridIndexTest, points_beyond_the_capacity_are_counted) {
  GridIndex index = make(100);
  const auto cloud = test::make_cloud(Family::kSurface, 130, 1);

  const auto report = index.rebuild(cloud.view());

  EXPECT_EQ(report.num_indexed, 100U);
  EXPECT_EQ(report.dropped_full, 30U);
}

TEST_F(GridIndexTest, a_question_that_is_not_a_place_has_no_answer) {
  GridIndex index = make(1000);
  const auto cloud = test::make_cloud(Family::kSurface, 1000, 1);
  index.rebuild(cloud.view());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Neighbour> found(3);

  EXPECT_EQ(index.nearest({nan, 0.0F, 0.0F}).index, kNoPoint);
  EXPECT_EQ(index.nearest({0.0F, 0.0F, 0.0F}, nan).index, kNoPoint);
  EXPECT_EQ(index.k_nearest({0.0F, nan, 0.0F}, found), 0U);
  EXPECT_EQ(index.radius({0.0F, 0.0F, 0.0F}, nan, found), 0U);
}

TEST_F(GridIndexTest, nearest_stops_at_its_limit) {
  GridIndex index = make(10);
  test::OwnedCloud cloud;
  cloud.add(3.0F, 4.0F, 0.0F);
  index.rebuild(cloud.view());

  EXPECT_EQ(index.nearest({}, 5.0F).index, 0U);
  EXPECT_EQ(index.nearest({}, 4.99F).index, kNoPoint);
}

TEST_F(GridIndexTest, rebuilding_and_asking_allocate_nothing) {
  GridIndex index = make(5000);
  const auto cloud = test::make_cloud(Family::kHalfOutliers, 5000, 1);
  std::vector<Neighbour> found(5000 * 5);
  std::vector<float> means(5000);
  const test::AllocationCounter allocations;

  index.rebuild(cloud.view());
  index.k_nearest_of_all(5, found);
  index.mean_distances(5, means);
  (void)index.radius({}, 50.0F, found);
  (void)index.k_nearest({}, std::span(found).first(20));

  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace dseam::search
