// SPDX-License-Identifier: Apache-2.0
#include "dseam/base/arena.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

namespace dseam {
namespace {

TEST(Arena, bytes_of_a_request_are_enough_for_it_wherever_the_memory_starts) {
  alignas(64) std::array<std::byte, Arena::bytes<double>(10) + 1> memory{};
  for (std::size_t start = 0; start < 2; ++start) {
    Arena arena(std::span<std::byte>(memory).subspan(start, Arena::bytes<double>(10)));

    const auto taken = arena.take<double>(10);

    EXPECT_EQ(taken.size(), 10U);
    EXPECT_FALSE(arena.exhausted());
  }
}

TEST(Arena, what_does_not_fit_is_empty_and_remembered) {
  std::array<std::byte, 64> memory{};
  Arena arena(memory);

  EXPECT_TRUE(arena.take<double>(100).empty());

  EXPECT_TRUE(arena.exhausted());
}

TEST(Arena, a_request_whose_size_overflows_does_not_fit) {
  std::array<std::byte, 64> memory{};
  Arena arena(memory);

  volatile std::size_t count = SIZE_MAX / 4;  // Volatile: the compiler would warn of the size.
  EXPECT_TRUE(arena.take<double>(count).empty());
}

TEST(ArenaDeathTest, a_sealed_arena_hands_out_nothing) {
  std::array<std::byte, 64> memory{};
  Arena arena(memory);
  arena.seal();

  EXPECT_DEATH((void)arena.take<char>(1), "");
}

}  // namespace
}  // namespace dseam
