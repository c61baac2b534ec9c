// SPDX-License-Identifier: Apache-2.0
#include "dseam/search/voxel_hash.hpp"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "dseam/base/random.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"

namespace dseam::search {
namespace {

class VoxelHashTest : public ::testing::Test {
 protected:
  VoxelHash make(std::size_t max_cells, std::uint64_t secret = 1) {
    return VoxelHash::make(max_cells, memory_.arena(), secret).value();
  }

  test::ArenaOwner memory_{2 * VoxelHash::bytes(20000)};
};

TEST_F(VoxelHashTest, keys_give_their_axes_back) {
  for (const std::int32_t axis : {-CellKey::kMaxAxis, -1, 0, 1, CellKey::kMaxAxis - 1}) {
    const CellKey key = CellKey::of(axis, -axis - 1, 5);

    EXPECT_EQ(std::tuple(key.x(), key.y(), key.z()), std::tuple(axis, -axis - 1, 5));
  }
}

TEST_F(VoxelHashTest, numbers_cells_as_a_map_does_whatever_the_secret) {
  VoxelHash one = make(20000, 1);
  VoxelHash other = make(20000, 0xDEADBEEF);
  std::map<std::uint64_t, std::uint32_t> truth;
  Pcg32 random(5);
  for (int i = 0; i < 40000; ++i) {
    const auto axis = [&] { return static_cast<std::int32_t>(random.below(25)) - 12; };
    const CellKey key = CellKey::of(axis(), axis(), axis());
    const auto number = truth.emplace(key.bits, truth.size()).first->second;

    ASSERT_EQ(one.find_or_insert(key), number);
    ASSERT_EQ(other.find_or_insert(key), number);
    ASSERT_EQ(one.find(key), number);
  }
  EXPECT_EQ(one.size(), truth.size());
}

TEST_F(VoxelHashTest, a_full_table_says_so_and_keeps_what_it_has) {
  VoxelHash hash = make(100);
  for (std::int32_t i = 0; i < 100; ++i) {
    ASSERT_EQ(hash.find_or_insert(CellKey::of(i, 0, 0)), static_cast<std::uint32_t>(i));
  }

  EXPECT_EQ(hash.find_or_insert(CellKey::of(100, 0, 0)), VoxelHash::kFull);

  EXPECT_EQ(hash.find(CellKey::of(42, 0, 0)), 42U);
  EXPECT_EQ(hash.find(CellKey::of(100, 0, 0)), VoxelHash::kAbsent);
  EXPECT_EQ(hash.size(), 100U);
}

TEST_F(VoxelHashTest, every_small_table_holds_as_many_cells_as_it_promises) {
  for (std::int32_t capacity = 1; capacity <= 64; ++capacity) {
    for (std::uint64_t secret = 0; secret < 20; ++secret) {
      for (const std::int32_t step : {1, 2, 8}) {  // Dense, all even, one in a line.
        test::ArenaOwner memory(VoxelHash::bytes(static_cast<std::size_t>(capacity)));
        VoxelHash hash =
            VoxelHash::make(static_cast<std::size_t>(capacity), memory.arena(), secret).value();
        for (std::int32_t i = 0; i < capacity; ++i) {
          const CellKey key = CellKey::of(i % 4 * step, i / 4 % 4 * step, i / 16 * step);
          ASSERT_EQ(hash.find_or_insert(key), static_cast<std::uint32_t>(i));
        }
      }
    }
  }
}

TEST_F(VoxelHashTest, a_large_table_of_cells_that_are_all_even_fills_up_too) {
  VoxelHash hash = make(20000);
  for (std::int32_t i = 0; i < 20000; ++i) {
    ASSERT_NE(hash.find_or_insert(CellKey::of(i % 50 * 2, i / 50 % 50 * 2, i / 2500 * 2)),
              VoxelHash::kFull);
  }
}

TEST_F(VoxelHashTest, keys_that_differ_in_few_high_bits_all_find_room) {
  VoxelHash hash = make(20000);
  for (std::int32_t i = 0; i < 20000; ++i) {
    // Multiples of a power of two: a hash that only masks puts them all into one slot.
    const CellKey key = CellKey::of(0, 0, (i % 1000 - 500) * 2048 / 2 + i / 1000);
    ASSERT_NE(hash.find_or_insert(key), VoxelHash::kFull);
  }
}

TEST_F(VoxelHashTest, a_cleared_table_numbers_from_zero_and_nothing_allocates) {
  VoxelHash hash = make(100);
  const test::AllocationCounter allocations;
  (void)hash.find_or_insert(CellKey::of(1, 2, 3));

  hash.clear();

  EXPECT_EQ(hash.find(CellKey::of(1, 2, 3)), VoxelHash::kAbsent);
  EXPECT_EQ(hash.find_or_insert(CellKey::of(4, 5, 6)), 0U);
  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace dseam::search
