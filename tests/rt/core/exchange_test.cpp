// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "dseam/rt/latest_value.hpp"
#include "dseam/rt/queue.hpp"
#include "support/allocation_counter.hpp"
#include "support/message_count.hpp"

namespace {

using dseam::rt::LatestValue;
using dseam::rt::Queue;

/// Large enough that a torn copy would show.
struct Big {
  std::array<std::uint64_t, 16> words{};
  static Big of(std::uint64_t n) {
    Big big;
    big.words.fill(n);
    return big;
  }
  [[nodiscard]] bool whole() const {
    for (const auto word : words) {
      if (word != words[0]) {
        return false;
      }
    }
    return true;
  }
};

TEST(LatestValue, gives_each_value_once_and_the_newest_of_several) {
  LatestValue<int> box;
  int out = -1;

  EXPECT_FALSE(box.read(out));
  box.write(1);
  box.write(2);
  EXPECT_TRUE(box.read(out));
  EXPECT_EQ(out, 2);
  EXPECT_FALSE(box.read(out));
  EXPECT_EQ(out, 2);
}

TEST(LatestValue, is_never_torn_and_never_goes_back_between_threads) {
  const std::uint64_t count = dseam::test::message_count(2'000'000);
  LatestValue<Big> box;
  std::thread writer([&] {
    for (std::uint64_t n = 1; n <= count; ++n) {
      box.write(Big::of(n));
    }
  });
  std::uint64_t last = 0;
  std::uint64_t wrong = 0;
  while (last < count) {
    Big big;
    if (box.read(big)) {
      wrong += !big.whole() || big.words[0] <= last ? 1U : 0U;
      last = big.words[0];
    } else {
      std::this_thread::yield();
    }
  }
  writer.join();

  EXPECT_EQ(wrong, 0U);
}

TEST(Queue, refuses_and_counts_what_does_not_fit) {
  Queue<int, 2> queue;
  const dseam::test::AllocationCounter counter;
  int out = 0;

  EXPECT_FALSE(queue.pop(out));
  EXPECT_TRUE(queue.push(1));
  EXPECT_TRUE(queue.push(2));
  EXPECT_FALSE(queue.push(3));
  EXPECT_EQ(queue.refused(), 1U);
  EXPECT_TRUE(queue.pop(out));
  EXPECT_EQ(out, 1);
  EXPECT_EQ(counter.count(), 0U);
}

TEST(Queue, passes_every_message_in_order_between_threads) {
  const std::uint64_t count = dseam::test::message_count(2'000'000);
  Queue<std::uint64_t, 1024> queue;
  std::thread writer([&] {
    for (std::uint64_t n = 0; n < count;) {
      if (queue.push(n)) {
        ++n;
      } else {
        std::this_thread::yield();
      }
    }
  });
  std::uint64_t wrong = 0;
  for (std::uint64_t n = 0; n < count;) {
    std::uint64_t got = 0;
    if (queue.pop(got)) {
      wrong += got != n ? 1U : 0U;
      ++n;
    } else {
      std::this_thread::yield();
    }
  }
  writer.join();

  EXPECT_EQ(wrong, 0U);
}

}  // namespace
