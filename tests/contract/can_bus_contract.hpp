// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdint>

#include "dseam/hal/can_bus.hpp"
#include "support/allocation_counter.hpp"

namespace dseam::test {

/// What every CAN bus must do. A backend instantiates it with a type of its own:
///
///   struct Device {
///     hal::CanBus& a();  hal::CanBus& b();   two nodes of one bus
///     void pass(std::chrono::nanoseconds);   lets time go by
///     bool fd();                             whether the bus carries FD frames
///     static constexpr bool kCanGoDown;      void set_down(bool);
///     static constexpr bool kPriority;       an urgent frame overtakes what waits
///   };
template <typename Device>
class CanBusContract : public ::testing::Test {
 protected:
  static constexpr auto kNoWait = std::chrono::nanoseconds(0);
  static constexpr auto kPatience = std::chrono::seconds(2);

  static hal::CanFrame frame_of(std::uint32_t id, std::uint8_t size, bool fd = false) {
    hal::CanFrame frame;
    frame.id = id;
    frame.fd = fd;
    frame.size_bytes = size;
    for (std::size_t i = 0; i < size; ++i) {
      frame.data[i] = static_cast<std::byte>(id + 7 * i);
    }
    return frame;
  }
  /// Sends, waiting for room where there is none.
  void must_send(hal::CanBus& bus, const hal::CanFrame& frame) {
    auto sent = bus.send(frame);
    for (int i = 0; i < 1000 && !sent.ok() && sent.error() == Errc::kQueueFull; ++i) {
      (void)bus.receive(kNoWait);
      device_.pass(std::chrono::milliseconds(1));
      sent = bus.send(frame);
    }
    ASSERT_TRUE(sent.ok()) << name(sent.error());
  }
  /// The next frame at `bus`, while `other` keeps its own queue going.
  Result<hal::CanFrame> next(hal::CanBus& bus, hal::CanBus& other) {
    for (int i = 0; i < 2000; ++i) {
      (void)other.receive(kNoWait);
      const auto received = bus.receive(kNoWait);
      if (received.ok() || received.error() != Errc::kTimeout) {
        return received;
      }
      device_.pass(std::chrono::milliseconds(1));
    }
    return Errc::kTimeout;
  }

  Device device_;
};
TYPED_TEST_SUITE_P(CanBusContract);

TYPED_TEST_P(CanBusContract, a_frame_of_every_size_arrives_whole) {
  constexpr std::array<std::uint8_t, 16> kSizes = {0, 1,  2,  3,  4,  5,  6,  7,
                                                   8, 12, 16, 20, 24, 32, 48, 64};
  for (const bool fd : {false, true}) {
    for (const std::uint8_t size : kSizes) {
      if ((fd && !this->device_.fd()) || (!fd && size > 8)) {
        continue;
      }
      const hal::CanFrame sent = this->frame_of(0x123, size, fd);
      this->must_send(this->device_.a(), sent);

      const auto received = this->next(this->device_.b(), this->device_.a());

      ASSERT_TRUE(received.ok());
      EXPECT_EQ(received.value().id, sent.id);
      EXPECT_EQ(received.value().fd, fd);
      EXPECT_FALSE(received.value().extended);
      EXPECT_EQ(received.value().size_bytes, size);
      EXPECT_EQ(received.value().data, sent.data);
    }
  }
}

TYPED_TEST_P(CanBusContract, an_identifier_of_29_bits_stays_one) {
  hal::CanFrame sent = this->frame_of(0x1234'5678, 3);
  sent.extended = true;
  this->must_send(this->device_.a(), sent);

  const auto received = this->next(this->device_.b(), this->device_.a());

  ASSERT_TRUE(received.ok());
  EXPECT_TRUE(received.value().extended);
  EXPECT_EQ(received.value().id, sent.id);
}

TYPED_TEST_P(CanBusContract, frames_of_one_identifier_keep_their_order) {
  for (std::uint8_t i = 0; i < 200; ++i) {
    hal::CanFrame frame = this->frame_of(0x100, 1);
    frame.data[0] = std::byte{i};
    this->must_send(this->device_.a(), frame);
    const auto received = this->next(this->device_.b(), this->device_.a());
    ASSERT_TRUE(received.ok());
    ASSERT_EQ(received.value().data[0], std::byte{i});
  }
}

TYPED_TEST_P(CanBusContract, nobody_hears_himself) {
  this->must_send(this->device_.a(), this->frame_of(0x100, 1));
  this->device_.pass(std::chrono::milliseconds(5));

  const auto received = this->device_.a().receive(this->kNoWait);

  ASSERT_FALSE(received.ok());
  EXPECT_EQ(received.error(), Errc::kTimeout);
}

TYPED_TEST_P(CanBusContract, a_frame_that_can_does_not_have_is_refused) {
  EXPECT_EQ(this->device_.a().send(this->frame_of(0x100, 9)).error(), Errc::kInvalidArgument);
  EXPECT_EQ(this->device_.a().send(this->frame_of(0x100, 13, true)).error(),
            Errc::kInvalidArgument);
  EXPECT_EQ(this->device_.a().send(this->frame_of(0x800, 1)).error(), Errc::kInvalidArgument);
}

TYPED_TEST_P(CanBusContract, a_silent_bus_is_a_timeout) {
  EXPECT_EQ(this->device_.a().receive(this->kNoWait).error(), Errc::kTimeout);
  EXPECT_EQ(this->device_.a().receive(std::chrono::milliseconds(3)).error(), Errc::kTimeout);
}

TYPED_TEST_P(CanBusContract, the_counters_tell_what_happened) {
  for (int i = 0; i < 5; ++i) {
    this->must_send(this->device_.a(), this->frame_of(0x100, 8));
    ASSERT_TRUE(this->next(this->device_.b(), this->device_.a()).ok());
  }
  // A controller confirms when the last bit is out, which may be after the frame was heard.
  for (int i = 0; i < 500 && this->device_.a().health().confirmed < 5; ++i) {
    (void)this->device_.a().receive(this->kNoWait);
    this->device_.pass(std::chrono::milliseconds(1));
  }

  const hal::BusHealth a = this->device_.a().health();
  EXPECT_EQ(a.sent, 5U);
  EXPECT_EQ(a.confirmed, 5U);
  EXPECT_EQ(a.state, hal::BusState::kErrorActive);
  EXPECT_EQ(this->device_.b().health().received, 5U);
}

TYPED_TEST_P(CanBusContract, a_sender_without_end_is_told_and_nothing_hangs) {
  int refused = 0;
  for (int i = 0; i < 100'000 && refused == 0; ++i) {
    const auto sent = this->device_.a().send(this->frame_of(0x100, 8));
    refused += sent.ok() ? 0 : 1;
    if (!sent.ok()) {
      EXPECT_EQ(sent.error(), Errc::kQueueFull);
    }
  }
  // A bus that takes whatever comes is allowed to lose it at the receiver, as long as it counts.
  while (this->next(this->device_.b(), this->device_.a()).ok()) {
  }

  const auto lost = this->device_.b().health().receive_overflow;
  EXPECT_TRUE(refused > 0 || lost > 0);
  this->must_send(this->device_.a(), this->frame_of(0x101, 1));
  EXPECT_TRUE(this->next(this->device_.b(), this->device_.a()).ok());
}

TYPED_TEST_P(CanBusContract, down_is_told_at_once_and_up_again_works) {
  if constexpr (TypeParam::kCanGoDown) {
    this->device_.set_down(true);
    EXPECT_EQ(this->device_.a().receive(this->kNoWait).error(), Errc::kDisconnected);
    EXPECT_EQ(this->device_.a().send(this->frame_of(0x100, 1)).error(), Errc::kDisconnected);
    EXPECT_NE(this->device_.a().health().state, hal::BusState::kErrorActive);
    (void)this->device_.b().receive(this->kNoWait);

    this->device_.set_down(false);
    this->device_.pass(std::chrono::milliseconds(300));
    (void)this->device_.b().receive(this->kNoWait);
    this->must_send(this->device_.a(), this->frame_of(0x100, 1));
    EXPECT_TRUE(this->next(this->device_.b(), this->device_.a()).ok());
  }
}

TYPED_TEST_P(CanBusContract, the_most_urgent_frame_never_finds_the_queue_full) {
  if constexpr (TypeParam::kPriority) {
    for (int i = 0; i < 300; ++i) {
      (void)this->device_.a().send(this->frame_of(0x200, 8));
    }
    EXPECT_TRUE(this->device_.a().send(this->frame_of(0x001, 8)).ok());
  }
}

TYPED_TEST_P(CanBusContract, sending_and_receiving_allocate_nothing) {
  this->must_send(this->device_.a(), this->frame_of(0x100, 8));
  ASSERT_TRUE(this->next(this->device_.b(), this->device_.a()).ok());
  const AllocationCounter counter;

  for (int i = 0; i < 50; ++i) {
    (void)this->device_.a().send(this->frame_of(0x100, 8));
    (void)this->device_.b().receive(this->kNoWait);
    (void)this->device_.a().receive(this->kNoWait);
    (void)this->device_.a().health();
    this->device_.pass(std::chrono::milliseconds(1));
  }

  EXPECT_EQ(counter.count() - this->device_.own_allocations(), 0U);
}

REGISTER_TYPED_TEST_SUITE_P(CanBusContract, a_frame_of_every_size_arrives_whole,
                            an_identifier_of_29_bits_stays_one,
                            frames_of_one_identifier_keep_their_order, nobody_hears_himself,
                            a_frame_that_can_does_not_have_is_refused, a_silent_bus_is_a_timeout,
                            the_counters_tell_what_happened,
                            a_sender_without_end_is_told_and_nothing_hangs,
                            down_is_told_at_once_and_up_again_works,
                            the_most_urgent_frame_never_finds_the_queue_full,
                            sending_and_receiving_allocate_nothing);

}  // namespace dseam::test
