// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dseam/cloud/crop_box.hpp"
#include "dseam/cloud/outlier_removal.hpp"
#include "dseam/cloud/radius_outlier_removal.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/clouds.hpp"

namespace dseam::cloud {
namespace {

using search::GridIndex;
using test::Family;
using test::OwnedCloud;

using Indices = std::vector<std::uint32_t>;

/// The textbook answers, by all pairs.
class FilterOracle : public ::testing::TestWithParam<int> {
 protected:
  static constexpr std::size_t kMostPoints = 600;

  FilterOracle() : index_(GridIndex::make(kMostPoints, memory_.arena()).value()) {}

  template <typename Check>
  void for_each_cloud(const Check& check) {
    const auto family = static_cast<Family>(GetParam());
    for (std::uint64_t seed = 0; seed < 30 && !HasFailure(); ++seed) {
      const std::size_t size = seed < 20 ? 1 + seed * seed : kMostPoints;
      SCOPED_TRACE("n=" + std::to_string(size) + " seed=" + std::to_string(seed));
      const OwnedCloud cloud = test::make_cloud(family, size, seed);
      index_.rebuild(cloud.view());
      check(cloud, Pcg32(seed));
    }
  }

  static bool is_finite(geometry::Vec3f p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  }
  static std::vector<float> squared_distances(const OwnedCloud& cloud, std::size_t i) {
    std::vector<float> all;
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      if (j != i && is_finite(cloud.view()[j])) {
        all.push_back(geometry::squared_norm(cloud.view()[j] - cloud.view()[i]));
      }
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  test::ArenaOwner memory_{GridIndex::bytes(kMostPoints) + OutlierRemoval::bytes(kMostPoints) +
                           RadiusOutlierRemoval::bytes(kMostPoints) + 4096};
  GridIndex index_;
  Indices storage_ = Indices(kMostPoints);
  Buffer<std::uint32_t> kept_{storage_};
};

Indices list_of(const Buffer<std::uint32_t>& kept) {
  return {kept.view().begin(), kept.view().end()};
}

TEST_P(FilterOracle, statistical_outlier_removal_keeps_what_equations_2_to_5_keep) {
  auto stage = OutlierRemoval::make({}, kMostPoints, memory_.arena()).value();
  for_each_cloud([&](const OwnedCloud& cloud, Pcg32) {
    std::vector<std::pair<std::uint32_t, float>> means;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      if (is_finite(cloud.view()[i])) {
        const auto all = squared_distances(cloud, i);
        const std::size_t k = std::min<std::size_t>(5, all.size());
        float sum = 0.0F;
        for (std::size_t j = 0; j < k; ++j) {
          sum += std::sqrt(all[j]);
        }
        means.emplace_back(i, k == 0 ? 0.0F : sum / static_cast<float>(k));
      }
    }
    double mean = 0.0;
    double squares = 0.0;
    for (const auto& [i, d] : means) {
      mean += static_cast<double>(d) / static_cast<double>(means.size());
    }
    for (const auto& [i, d] : means) {
      squares += (static_cast<double>(d) - mean) * (static_cast<double>(d) - mean);
    }
    const double limit = mean + std::sqrt(squares / static_cast<double>(means.size()));

    const auto report = stage.run(index_, cloud.size(), kept_);

    // A distance that equals the limit within rounding may go either way.
    Indices surely;
    Indices perhaps;
    for (const auto& [i, d] : means) {
      const double over = static_cast<double>(d) - limit;
      const double rounding = 1e-9 * limit;
      if (over < -rounding) {
        surely.push_back(i);
      }
      if (over <= rounding) {
        perhaps.push_back(i);
      }
    }
    const Indices kept = list_of(kept_);
    EXPECT_TRUE(std::includes(kept.begin(), kept.end(), surely.begin(), surely.end()));
    EXPECT_TRUE(std::includes(perhaps.begin(), perhaps.end(), kept.begin(), kept.end()));
    EXPECT_EQ(report.kept + report.removed, cloud.size());
    EXPECT_EQ(report.too_few_points, means.size() <= 5);
  });
}

TEST_P(FilterOracle, radius_outlier_removal_keeps_points_with_enough_others) {
  auto stage = RadiusOutlierRemoval::make({.radius_mm = 1.5F, .min_neighbours = 3}, kMostPoints,
                                          memory_.arena())
                   .value();
  for_each_cloud([&](const OwnedCloud& cloud, Pcg32) {
    Indices expected;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      if (is_finite(cloud.view()[i])) {
        const auto all = squared_distances(cloud, i);
        const auto within = std::upper_bound(all.begin(), all.end(), 2.25F) - all.begin();
        if (within >= 3) {
          expected.push_back(i);
        }
      }
    }

    const auto report = stage.run(index_, cloud.size(), kept_);

    EXPECT_EQ(list_of(kept_), expected);
    EXPECT_EQ(report.kept + report.removed, cloud.size());
  });
}

TEST_P(FilterOracle, crop_box_keeps_what_lies_inside_an_oriented_box) {
  for_each_cloud([&](const OwnedCloud& cloud, Pcg32 random) {
    OrientedBox box;
    const auto size = [&] { return static_cast<float>(random.below(4000)) * 0.0625F - 125.0F; };
    box.low_mm = {size(), size(), size()};
    box.high_mm = box.low_mm + geometry::Vec3f{100.0F, 120.0F, 150.0F};
    if (random.below(2) == 1) {
      box.T_box_cloud = {{0.0F, 1.0F, 0.0F}, {-0.8F, 0.0F, 0.6F}, {0.6F, 0.0F, 0.8F}, {1, 2, 3}};
    }
    Indices expected;
    std::uint32_t not_finite = 0;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      const geometry::Vec3f p =
          box.is_aligned() ? cloud.view()[i] : box.T_box_cloud * cloud.view()[i];
      not_finite += is_finite(cloud.view()[i]) ? 0U : 1U;
      if (is_finite(cloud.view()[i]) && p.x >= box.low_mm.x && p.y >= box.low_mm.y &&
          p.z >= box.low_mm.z && p.x <= box.high_mm.x && p.y <= box.high_mm.y &&
          p.z <= box.high_mm.z) {
        expected.push_back(i);
      }
    }

    const auto report = CropBox::make({box}).value().run(cloud.view(), kept_);

    EXPECT_EQ(list_of(kept_), expected);
    EXPECT_EQ(report.dropped_not_finite, not_finite);
    EXPECT_EQ(report.kept + report.dropped_not_finite + report.dropped_outside, cloud.size());
  });
}

INSTANTIATE_TEST_SUITE_P(Families, FilterOracle, ::testing::Range(0, test::kNumFamilies),
                         [](const auto& family) {
                           return std::string(test::name(static_cast<Family>(family.param)));
                         });

TEST(Filters, refuse_what_makes_no_sense) {
  test::ArenaOwner memory(100);
  OrientedBox inside_out;
  inside_out.low_mm.x = 1.0F;
  inside_out.high_mm.x = 0.0F;

  EXPECT_FALSE(CropBox::make({inside_out}).ok());
  EXPECT_FALSE(OutlierRemoval::make({.num_neighbours = 0}, 1, memory.arena()).ok());
  EXPECT_FALSE(OutlierRemoval::make({.num_neighbours = 65}, 1, memory.arena()).ok());
  EXPECT_FALSE(OutlierRemoval::make({.alpha = NAN}, 1, memory.arena()).ok());
  EXPECT_FALSE(RadiusOutlierRemoval::make({.radius_mm = 0.0F}, 1, memory.arena()).ok());
  EXPECT_EQ(OutlierRemoval::make({}, 1000, memory.arena()).error(), Errc::kOutOfMemory);
}

TEST(Filters, a_full_list_is_counted_and_keeps_what_fitted_and_nothing_allocates) {
  test::ArenaOwner memory(GridIndex::bytes(500) + OutlierRemoval::bytes(500) +
                          RadiusOutlierRemoval::bytes(500));
  const OwnedCloud cloud = test::make_cloud(Family::kSurface, 500, 1);
  GridIndex index = GridIndex::make(500, memory.arena()).value();
  index.rebuild(cloud.view());
  auto statistical = OutlierRemoval::make({}, 500, memory.arena()).value();
  auto radius = RadiusOutlierRemoval::make({}, 500, memory.arena()).value();
  Indices storage(100);
  Buffer<std::uint32_t> kept(storage);
  const test::AllocationCounter allocations;

  EXPECT_GT(statistical.run(index, 500, kept).dropped_full, 0U);
  EXPECT_EQ(kept.size(), 100U);
  EXPECT_GT(radius.run(index, 500, kept).dropped_full, 0U);
  EXPECT_EQ(kept.size(), 100U);
  EXPECT_EQ(CropBox::make({}).value().run(cloud.view(), kept).dropped_full, 400U);
  EXPECT_EQ(kept.size(), 100U);

  EXPECT_EQ(allocations.count(), 0U);
}

TEST(Filters, kept_points_can_be_copied_onto_their_own_storage) {
  OwnedCloud cloud;
  for (int i = 0; i < 5; ++i) {
    cloud.add(static_cast<float>(i), 0.0F, 0.0F);
  }
  CloudBuffer same(cloud.x, cloud.y, cloud.z);
  const Indices kept{1, 3, 4};

  EXPECT_EQ(copy_kept(cloud.view(), kept, same), 0U);

  EXPECT_EQ(same.size(), 3U);
  EXPECT_EQ(same[2].x, 4.0F);
}

}  // namespace
}  // namespace dseam::cloud
