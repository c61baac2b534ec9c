// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <thread>
#include <vector>

#include "dseam/depth/frame_decoder.hpp"
#include "dseam/depth/sample_layout.hpp"
#include "dseam/hal/depth_camera.hpp"
#include "support/allocation_counter.hpp"

namespace dseam::test {

using namespace std::chrono_literals;

/// What every depth camera must do. A backend instantiates it with a type of its own:
///
///   struct Device {
///     hal::DepthCamera& camera();
///     std::int64_t now_ns();                    its clock, which `captured_ns` follows
///     void pass(std::chrono::nanoseconds);      lets time go by
///     static constexpr bool kLive;              frames come by themselves and overtake each other
///     static constexpr bool kCanUnplug;         void unplug(); void plug_in();
///     static constexpr bool kOwnThreadOnly;     no allocation is counted in other threads
///   };
template <typename Device>
class DepthCameraContract : public ::testing::Test {
 protected:
  static constexpr auto kPatience = 5s;

  hal::DepthCamera& camera() { return device_.camera(); }
  /// The next frame; fails the test when none comes.
  hal::FrameLease must_next() {
    auto lease = camera().next(kPatience);
    EXPECT_TRUE(lease.ok()) << name(lease.error());
    return lease.ok() ? std::move(lease.value()) : hal::FrameLease();
  }

  Device device_;
};
TYPED_TEST_SUITE_P(DepthCameraContract);

TYPED_TEST_P(DepthCameraContract, the_model_can_be_decoded_and_fits_the_frames) {
  const auto decoder = depth::FrameDecoder::make(this->camera().model());
  ASSERT_TRUE(decoder.ok());
  std::vector<std::uint16_t> counts(decoder.value().pixels());
  std::vector<std::uint8_t> shades(decoder.value().pixels());
  ASSERT_TRUE(this->camera().start(hal::FrameMode::kEvery).ok());

  const auto lease = this->must_next();
  const auto report =
      decoder.value().run({lease.frame().depth, lease.frame().gray}, {counts, shades});

  EXPECT_EQ(report.fault, depth::FrameDecoder::Fault::kNone);
}

TYPED_TEST_P(DepthCameraContract, frames_come_in_order_with_time_stamps_that_only_rise) {
  ASSERT_TRUE(this->camera().start(hal::FrameMode::kEvery).ok());

  hal::DepthFrame before = this->must_next().frame();
  for (int i = 0; i < 8; ++i) {
    const auto lease = this->must_next();
    const hal::DepthFrame& frame = lease.frame();

    EXPECT_EQ(frame.sequence, before.sequence + 1 + frame.gap);
    EXPECT_GT(frame.device_ns, before.device_ns);
    EXPECT_GE(frame.captured_ns, before.captured_ns);
    EXPECT_GE(frame.dequeued_ns, before.dequeued_ns);
    EXPECT_LE(frame.captured_ns, frame.dequeued_ns);
    EXPECT_LE(frame.dequeued_ns, this->device_.now_ns());
    before = frame;
  }
  EXPECT_EQ(this->camera().health().delivered, 9U);
}

TYPED_TEST_P(DepthCameraContract, a_camera_that_was_not_started_says_so) {
  EXPECT_EQ(this->camera().next(0ns).error(), Errc::kUnavailable);

  ASSERT_TRUE(this->camera().start(hal::FrameMode::kEvery).ok());
  EXPECT_EQ(this->camera().start(hal::FrameMode::kEvery).error(), Errc::kUnavailable);
}

TYPED_TEST_P(DepthCameraContract, it_can_be_stopped_twice_and_started_again) {
  ASSERT_TRUE(this->camera().start(hal::FrameMode::kEvery).ok());
  const std::uint64_t first = this->must_next().frame().sequence;

  this->camera().stop();
  this->camera().stop();
  EXPECT_EQ(this->camera().next(0ns).error(), Errc::kUnavailable);

  ASSERT_TRUE(this->camera().start(hal::FrameMode::kLatest).ok());
  EXPECT_GE(this->must_next().frame().sequence, first);
}

TYPED_TEST_P(DepthCameraContract, stop_is_quick_also_while_another_thread_waits) {
  ASSERT_TRUE(this->camera().start(hal::FrameMode::kEvery).ok());
  (void)this->must_next();
  std::thread consumer([this] {
    while (this->camera().next(50ms).ok()) {
    }
  });

  const auto begin = std::chrono::steady_clock::now();
  this->camera().stop();
  const auto took = std::chrono::steady_clock::now() - begin;
  consumer.join();

  EXPECT_LT(took, 100ms);
}

TYPED_TEST_P(DepthCameraContract, a_frame_on_loan_keeps_its_bytes_while_others_come) {
  ASSERT_TRUE(this->camera().start(hal::FrameMode::kEvery).ok());
  const auto held = this->must_next();
  const auto bytes = held.frame().depth;
  const std::vector<std::byte> copy(bytes.begin(), bytes.end());

  for (int i = 0; i < 6; ++i) {
    const auto other = this->must_next();
    EXPECT_NE(other.frame().depth.data(), bytes.data());
  }

  EXPECT_EQ(std::memcmp(copy.data(), bytes.data(), copy.size()), 0);
}

TYPED_TEST_P(DepthCameraContract, a_loan_may_end_in_another_thread_and_after_stop) {
  ASSERT_TRUE(this->camera().start(hal::FrameMode::kEvery).ok());
  auto ended_elsewhere = this->must_next();
  auto ended_late = this->must_next();

  const auto before = ended_late.frame().depth;
  const std::vector<std::byte> bytes(before.begin(), before.end());
  std::thread([lease = std::move(ended_elsewhere)]() mutable { lease = hal::FrameLease(); }).join();
  this->camera().stop();
  const auto after = ended_late.frame().depth;
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), after.begin(), after.end()));
  ended_late = hal::FrameLease();

  ASSERT_TRUE(this->camera().start(hal::FrameMode::kEvery).ok());
  EXPECT_TRUE(this->camera().next(this->kPatience).ok());
}

TYPED_TEST_P(DepthCameraContract, when_every_buffer_is_out_on_loan_it_recovers_after_one_is_back) {
  ASSERT_TRUE(this->camera().start(hal::FrameMode::kEvery).ok());
  std::vector<hal::FrameLease> hoard;
  for (auto lease = this->camera().next(300ms); lease.ok() && hoard.size() < 64;
       lease = this->camera().next(300ms)) {
    hoard.push_back(std::move(lease.value()));
  }
  ASSERT_GE(hoard.size(), 2U);

  hoard.clear();

  for (int i = 0; i < 3; ++i) {
    (void)this->must_next();
  }
}

TYPED_TEST_P(DepthCameraContract, taking_and_returning_frames_allocates_nothing) {
  ASSERT_TRUE(this->camera().start(hal::FrameMode::kEvery).ok());
  (void)this->must_next();

  const ThreadAllocationCounter here;
  const AllocationCounter everywhere;
  for (int i = 0; i < 5; ++i) {
    (void)this->camera().next(1s);
  }
  const auto in_this_thread = here.count();
  const auto in_any_thread = everywhere.count();

  EXPECT_EQ(in_this_thread, 0U);
  EXPECT_TRUE(!TypeParam::kOwnThreadOnly || in_any_thread == 0);
}

TYPED_TEST_P(DepthCameraContract, next_waits_no_longer_than_it_is_told) {
  constexpr auto kSlack = 200ms;  // For a computer that has other things to do.
  ASSERT_TRUE(this->camera().start(hal::FrameMode::kEvery).ok());
  std::vector<hal::FrameLease> hoard;  // In the end there is no buffer for another frame.

  for (const auto patience : {0ms, 20ms, 0ms, 20ms, 0ms, 20ms, 0ms, 20ms}) {
    for (int i = 0; i < 8; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      auto lease = this->camera().next(patience);
      EXPECT_LT(std::chrono::steady_clock::now() - begin, patience + kSlack);
      if (lease.ok()) {
        hoard.push_back(std::move(lease.value()));
      }
    }
  }
}

TYPED_TEST_P(DepthCameraContract, the_latest_mode_drains_to_the_newest_frame) {
  ASSERT_TRUE(this->camera().start(hal::FrameMode::kLatest).ok());
  (void)this->must_next();

  const auto first = this->must_next();
  this->device_.pass(1s);
  const auto lease = this->must_next();

  if constexpr (TypeParam::kLive) {
    EXPECT_GT(this->camera().health().skipped, 0U);
    EXPECT_GT(lease.frame().sequence, first.frame().sequence + 1);
  } else {
    EXPECT_EQ(lease.frame().sequence, first.frame().sequence + 1);
  }
}

TYPED_TEST_P(DepthCameraContract, an_unplugged_camera_says_so_and_comes_back_by_itself) {
  ASSERT_TRUE(this->camera().start(hal::FrameMode::kEvery).ok());
  auto held = this->must_next();
  const std::uint64_t before = held.frame().sequence;
  if constexpr (TypeParam::kCanUnplug) {
    const auto bytes = held.frame().depth;
    const std::vector<std::byte> copy(bytes.begin(), bytes.end());
    this->device_.unplug();
    Errc seen = Errc::kTimeout;
    for (int i = 0; i < 400 && seen != Errc::kDisconnected; ++i) {
      const auto lease = this->camera().next(50ms);
      seen = lease.ok() ? Errc::kTimeout : lease.error();
    }
    EXPECT_EQ(seen, Errc::kDisconnected);
    EXPECT_TRUE(std::equal(copy.begin(), copy.end(), bytes.begin(), bytes.end()));
    held = hal::FrameLease();  // A mapped buffer on loan keeps a driver from coming back.

    this->device_.plug_in();
    bool back = false;
    for (int i = 0; i < 400 && !back; ++i) {
      back = this->camera().next(50ms).ok();
    }
    EXPECT_TRUE(back);
    EXPECT_EQ(this->camera().health().reconnects, 1U);
  }
  EXPECT_GE(this->must_next().frame().sequence, before);
}

REGISTER_TYPED_TEST_SUITE_P(DepthCameraContract, the_model_can_be_decoded_and_fits_the_frames,
                            frames_come_in_order_with_time_stamps_that_only_rise,
                            a_camera_that_was_not_started_says_so,
                            it_can_be_stopped_twice_and_started_again,
                            stop_is_quick_also_while_another_thread_waits,
                            a_frame_on_loan_keeps_its_bytes_while_others_come,
                            a_loan_may_end_in_another_thread_and_after_stop,
                            when_every_buffer_is_out_on_loan_it_recovers_after_one_is_back,
                            taking_and_returning_frames_allocates_nothing,
                            next_waits_no_longer_than_it_is_told,
                            the_latest_mode_drains_to_the_newest_frame,
                            an_unplugged_camera_says_so_and_comes_back_by_itself);

}  // namespace dseam::test
