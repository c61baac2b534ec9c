// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/camera/slot_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <thread>
#include <vector>

namespace dseam::hal {
namespace {

TEST(SlotPool, every_slot_is_lent_once_and_then_none_is_left) {
  SlotPool pool(SlotPool::kMaxSlots);
  std::set<std::uint32_t> taken;
  for (std::uint32_t i = 0; i < SlotPool::kMaxSlots; ++i) {
    taken.insert(pool.take());
  }

  EXPECT_EQ(taken.size(), SlotPool::kMaxSlots);
  EXPECT_EQ(pool.take(), SlotPool::kNone);
  EXPECT_EQ(pool.num_lent(), SlotPool::kMaxSlots);
}

TEST(SlotPool, a_slot_that_came_back_is_lent_again) {
  SlotPool pool(1);
  const std::uint32_t slot = pool.take();

  pool.give_back(slot);

  EXPECT_EQ(pool.take(), slot);
}

TEST(SlotPool, no_slot_is_lent_twice_while_other_threads_give_back) {
  SlotPool pool(4);
  std::array<std::atomic<int>, 4> holders{};
  std::atomic<int> lent_twice{0};
  const auto borrow = [&] {
    for (int i = 0; i < 20'000; ++i) {
      const std::uint32_t slot = pool.take();
      if (slot == SlotPool::kNone) {
        continue;
      }
      lent_twice += holders[slot]++ != 0 ? 1 : 0;
      --holders[slot];
      pool.give_back(slot);
    }
  };

  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i) {
    threads.emplace_back(borrow);
  }
  for (std::thread& thread : threads) {
    thread.join();
  }

  EXPECT_EQ(lent_twice, 0);
  EXPECT_EQ(pool.num_lent(), 0U);
}

}  // namespace
}  // namespace dseam::hal
