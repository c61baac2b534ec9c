// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dseam/search/grid_index.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/clouds.hpp"

namespace dseam::search {
namespace {

using test::Family;
using test::OwnedCloud;

bool in_rising_order(const Neighbour& a, const Neighbour& b) {
  return a.squared_mm2 < b.squared_mm2 || (a.squared_mm2 == b.squared_mm2 && a.index < b.index);
}

// All points but `self`, nearest first: the textbook answer.
std::vector<Neighbour> by_brute_force(const OwnedCloud& cloud, geometry::Vec3f p,
                                      std::uint32_t self) {
  std::vector<Neighbour> all;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const float dx = cloud.x[i] - p.x;
    const float dy = cloud.y[i] - p.y;
    const float dz = cloud.z[i] - p.z;
    const float squared = dx * dx + dy * dy + dz * dz;
    if (i != self && std::isfinite(squared)) {
      all.push_back({i, squared});
    }
  }
  std::sort(all.begin(), all.end(), in_rising_order);
  return all;
}

std::string text(std::span<const Neighbour> list) {
  std::string all;
  for (const Neighbour& n : list) {
    all += std::to_string(n.index) + "@" + std::to_string(n.squared_mm2) + " ";
  }
  return all;
}

void expect_same(std::span<const Neighbour> expected, std::span<const Neighbour> found) {
  const auto same = [](const Neighbour& a, const Neighbour& b) {
    return a.index == b.index && a.squared_mm2 == b.squared_mm2;
  };
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), found.begin(), found.end(), same))
      << "expected " << text(expected) << "\nfound    " << text(found);
}

std::size_t num_finite(const OwnedCloud& cloud) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const geometry::Vec3f p = cloud.view()[i];
    count += std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) ? 1U : 0U;
  }
  return count;
}

/// Every family at several sizes and seeds; `seeds` is what the quick and the long run differ in.
class GridOracle : public ::testing::TestWithParam<int> {
 protected:
  static constexpr std::size_t kSizes[] = {1, 2, 7, 8, 9, 65, 300};

  template <typename Check>
  void for_each_cloud(std::uint64_t seeds, const Check& check) {
    const auto family = static_cast<Family>(GetParam());
    for (const std::size_t size : kSizes) {
      for (std::uint64_t seed = 0; seed < seeds && !HasFailure(); ++seed) {
        SCOPED_TRACE(std::string(test::name(family)) + " n=" + std::to_string(size) +
                     " seed=" + std::to_string(seed));
        const OwnedCloud cloud = test::make_cloud(family, size, seed);
        test::ArenaOwner memory(GridIndex::bytes(size));
        GridIndex index = GridIndex::make(size, memory.arena()).value();
        index.rebuild(cloud.view());
        check(cloud, index, Pcg32(seed));
      }
    }
  }
};

TEST_P(GridOracle, k_nearest_of_all_are_the_textbook_ones) {
  for_each_cloud(12, [](const OwnedCloud& cloud, const GridIndex& index, Pcg32 random) {
    const std::size_t k = 1 + random.below(12);
    std::vector<Neighbour> found(cloud.size() * k, Neighbour{7, -1.0F});

    index.k_nearest_of_all(k, found);

    std::size_t answered = 0;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      const auto row = std::span<const Neighbour>(found).subspan(i * k, k);
      if (row[0].squared_mm2 != -1.0F) {
        ++answered;
        auto expected = by_brute_force(cloud, cloud.view()[i], i);
        expected.resize(k, Neighbour{kNoPoint, std::numeric_limits<float>::infinity()});
        expect_same(expected, row);
      }
    }
    EXPECT_EQ(answered, num_finite(cloud));
  });
}

TEST_P(GridOracle, mean_distances_are_those_of_the_textbook_neighbours) {
  for_each_cloud(12, [](const OwnedCloud& cloud, const GridIndex& index, Pcg32 random) {
    const std::size_t k = 1 + random.below(40);
    std::vector<float> found(cloud.size(), -1.0F);

    index.mean_distances(k, found);

    std::size_t answered = 0;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      if (found[i] != -1.0F) {
        ++answered;
        const auto expected = by_brute_force(cloud, cloud.view()[i], i);
        const std::size_t count = std::min(k, expected.size());
        float sum = 0.0F;
        for (std::size_t j = 0; j < count; ++j) {
          sum += std::sqrt(expected[j].squared_mm2);
        }
        EXPECT_EQ(found[i], count == 0 ? 0.0F : sum / static_cast<float>(count));
      }
    }
    EXPECT_EQ(answered, num_finite(cloud));
  });
}

TEST_P(GridOracle, queries_at_any_place_are_the_textbook_ones) {
  for_each_cloud(20, [](const OwnedCloud& cloud, const GridIndex& index, Pcg32 random) {
    for (int query = 0; query < 20; ++query) {
      geometry::Vec3f p = cloud.view()[random.below(static_cast<std::uint32_t>(cloud.size()))];
      const float off = static_cast<float>(random.below(5)) * 1.75F;
      p = {std::isfinite(p.x) ? p.x + off : 0.0F, std::isfinite(p.y) ? p.y - off : 0.0F,
           std::isfinite(p.z) ? p.z : 0.0F};
      const auto expected = by_brute_force(cloud, p, kNoPoint);
      std::vector<Neighbour> found(1 + random.below(20));

      const std::size_t count = index.k_nearest(p, found);
      const Neighbour nearest = index.nearest(p);

      const std::size_t wanted = std::min(found.size(), expected.size());
      expect_same(std::span(expected).first(wanted), std::span(found).first(count));
      EXPECT_EQ(nearest.index, expected.empty() ? kNoPoint : expected[0].index);
    }
  });
}

TEST_P(GridOracle, radius_queries_are_the_textbook_ones) {
  for_each_cloud(12, [](const OwnedCloud& cloud, const GridIndex& index, Pcg32 random) {
    const float radius_mm = static_cast<float>(random.below(8)) * 0.5F;
    std::vector<Neighbour> scratch(cloud.size());
    std::size_t answered = 0;
    index.for_each_radius(radius_mm, scratch, [&](std::uint32_t i, auto others) {
      ++answered;
      auto expected = by_brute_force(cloud, cloud.view()[i], i);
      std::erase_if(expected, [&](auto& n) { return n.squared_mm2 > radius_mm * radius_mm; });
      std::vector<Neighbour> sorted(others.begin(), others.end());
      std::sort(sorted.begin(), sorted.end(), in_rising_order);
      std::vector<Neighbour> found(5);

      const std::size_t count = index.radius(cloud.view()[i], radius_mm, found);

      expect_same(expected, sorted);
      EXPECT_EQ(count, expected.size() + 1);  // The single query finds the point itself too.
      EXPECT_EQ(found[0].squared_mm2, 0.0F);
      const std::size_t rest = std::min<std::size_t>(expected.size(), 4);
      for (std::size_t j = 0; j < rest; ++j) {
        EXPECT_EQ(found[j + 1].squared_mm2, expected[j].squared_mm2);
      }
    });
    EXPECT_EQ(answered, num_finite(cloud));
  });
}

// Larger than what the search collects around a block, so that the ways round that are taken too.
TEST_P(GridOracle, in_a_large_cloud_too_every_hundredth_row_is_the_textbook_one) {
  constexpr std::size_t kSize = 6000;
  const OwnedCloud cloud = test::make_cloud(static_cast<Family>(GetParam()), kSize, 3);
  test::ArenaOwner memory(GridIndex::bytes(kSize));
  GridIndex index = GridIndex::make(kSize, memory.arena()).value();
  index.rebuild(cloud.view());
  for (const std::size_t k : {5U, 17U, 40U}) {
    std::vector<Neighbour> found(kSize * k, Neighbour{7, -1.0F});
    std::vector<float> means(kSize, -1.0F);

    index.k_nearest_of_all(k, found);
    index.mean_distances(k, means);

    for (std::uint32_t i = 0; i < kSize; i += 100) {
      if (std::isfinite(cloud.x[i] + cloud.y[i] + cloud.z[i])) {
        const auto expected = by_brute_force(cloud, cloud.view()[i], i);
        expect_same(std::span(expected).first(k), std::span(found).subspan(i * k, k));
        float sum = 0.0F;
        for (std::size_t j = 0; j < k; ++j) {
          sum += std::sqrt(expected[j].squared_mm2);
        }
        EXPECT_EQ(means[i], sum / static_cast<float>(k));
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, GridOracle, ::testing::Range(0, test::kNumFamilies),
                         [](const auto& family) {
                           return std::string(test::name(static_cast<Family>(family.param)));
                         });

}  // namespace
}  // namespace dseam::search
