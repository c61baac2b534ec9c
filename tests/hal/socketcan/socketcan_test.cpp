// SPDX-License-Identifier: Apache-2.0
// What the kernel does to hal/socketcan in the field, with what was measured as the script.
#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <cerrno>

#include "dseam/hal/socketcan/socketcan_bus.hpp"
#include "hal/socketcan/fake_kernel.hpp"
#include "support/allocation_counter.hpp"

namespace dseam::test {
namespace {

using hal::BusState;
using hal::CanFrame;
using hal::socketcan::SocketCanBus;
using namespace std::chrono_literals;

CanFrame frame_of(std::uint32_t id, std::uint8_t size = 8) {
  CanFrame frame;
  frame.id = id;
  frame.fd = true;
  frame.size_bytes = size;
  return frame;
}

class SocketCan : public ::testing::Test {
 protected:
  std::unique_ptr<SocketCanBus> open(const SocketCanBus::Config& config = {}) {
    auto opened = SocketCanBus::open("can0", config, kernel_);
    EXPECT_TRUE(opened.ok());
    return opened.ok() ? std::move(opened.value()) : nullptr;
  }
  Errc open_error(const SocketCanBus::Config& config = {}) {
    const auto opened = SocketCanBus::open("can0", config, kernel_);
    return opened.ok() ? Errc::kInvalidArgument : opened.error();
  }

  FakeKernel kernel_;
};

TEST_F(SocketCan, names_why_an_interface_cannot_be_opened) {
  kernel_.remove();
  EXPECT_EQ(open_error(), Errc::kNotFound);
  kernel_.plug_in();
  kernel_.sabotage({kernel_.calls(), EAFNOSUPPORT, false});
  EXPECT_EQ(open_error(), Errc::kUnsupported);
  kernel_.sabotage({kernel_.calls(), EPERM, false});
  EXPECT_EQ(open_error(), Errc::kUnavailable);
  EXPECT_EQ(kernel_.open_sockets(), 0U);
}

TEST_F(SocketCan, refuses_fd_on_a_classic_interface) {
  FakeKernel classic(false);

  const auto opened = SocketCanBus::open("can0", {}, classic);

  ASSERT_FALSE(opened.ok());
  EXPECT_EQ(opened.error(), Errc::kUnsupported);
  EXPECT_EQ(classic.open_sockets(), 0U);
}

TEST_F(SocketCan, an_interface_that_is_down_opens_and_says_so) {
  kernel_.set_up(false);

  const auto bus = open();

  EXPECT_EQ(bus->health().state, BusState::kDown);
  EXPECT_EQ(bus->send(frame_of(1)).error(), Errc::kDisconnected);
}

TEST_F(SocketCan, comes_back_by_itself_after_down_and_up_without_the_old_frames) {
  const auto host = open();
  const auto peer = open();
  kernel_.set_stuck(true);
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(host->send(frame_of(1)).ok());
  }
  kernel_.set_up(false);
  EXPECT_EQ(host->receive(0ns).error(), Errc::kDisconnected);
  EXPECT_EQ(host->health().state, BusState::kDown);
  kernel_.set_up(true);
  kernel_.set_stuck(false);
  (void)peer->receive(0ns);
  kernel_.pass(200'000'000);

  EXPECT_TRUE(host->send(frame_of(2)).ok());

  EXPECT_EQ(host->reconnects(), 1U);
  const auto received = peer->receive(0ns);
  ASSERT_TRUE(received.ok());
  EXPECT_EQ(received.value().id, 2U);
  EXPECT_EQ(peer->receive(0ns).error(), Errc::kTimeout);
}

TEST_F(SocketCan, an_adapter_that_was_pulled_is_opened_again_when_it_is_back) {
  const auto bus = open();
  for (int i = 0; i < 200; ++i) {
    kernel_.remove();
    ASSERT_EQ(bus->receive(0ns).error(), Errc::kDisconnected);
    kernel_.pass(200'000'000);
    ASSERT_EQ(bus->receive(0ns).error(), Errc::kDisconnected);
    kernel_.plug_in();
    kernel_.pass(200'000'000);
    ASSERT_EQ(bus->receive(0ns).error(), Errc::kTimeout);
    ASSERT_TRUE(bus->send(frame_of(1)).ok());
    ASSERT_EQ(kernel_.open_sockets(), 2U);
  }
  EXPECT_EQ(bus->reconnects(), 200U);
}

TEST_F(SocketCan, a_moment_without_buffers_costs_nothing) {
  const auto host = open();
  const auto peer = open();
  kernel_.sabotage({kernel_.calls() + 0, ENOBUFS, false});

  EXPECT_TRUE(host->send(frame_of(1)).ok());
  EXPECT_EQ(host->receive(0ns).error(), Errc::kTimeout);

  EXPECT_TRUE(peer->receive(0ns).ok());
  EXPECT_EQ(host->health().state, BusState::kErrorActive);
}

TEST_F(SocketCan, a_bus_without_confirmations_is_dead_although_the_kernel_takes_frames) {
  const auto host = open();
  kernel_.set_stuck(true);
  ASSERT_TRUE(host->send(frame_of(1)).ok());
  kernel_.pass(150'000'000);

  EXPECT_EQ(host->send(frame_of(1)).error(), Errc::kDisconnected);
  EXPECT_EQ(host->health().state, BusState::kDown);
}

TEST_F(SocketCan, few_frames_lie_in_the_kernel_and_an_urgent_one_overtakes_the_rest) {
  const auto host = open();
  const auto peer = open();
  kernel_.set_stuck(true);
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(host->send(frame_of(0x125)).ok());
  }
  ASSERT_TRUE(host->send(frame_of(0x120)).ok());
  EXPECT_EQ(host->health().sent, 6U);
  kernel_.set_stuck(false);
  const auto other = open();
  ASSERT_TRUE(other->send(frame_of(0x7FF)).ok());  // Makes the stuck driver go on.
  for (int i = 0; i < 40; ++i) {
    (void)host->receive(0ns);
  }

  int place = 0;
  for (auto got = peer->receive(0ns); got.ok() && got.value().id != 0x120;
       got = peer->receive(0ns)) {
    ++place;
  }
  EXPECT_EQ(place, 7);  // Behind the six in the kernel and the other node's frame.
}

TEST_F(SocketCan, a_frame_that_waited_past_its_deadline_is_dropped_and_counted) {
  const auto host = open();
  const auto peer = open();
  kernel_.set_stuck(true);
  kernel_.set_queue_room(0);
  ASSERT_TRUE(host->send(frame_of(1)).ok());
  kernel_.set_stuck(false);
  kernel_.pass(60'000'000);

  (void)host->receive(0ns);

  EXPECT_EQ(peer->receive(0ns).error(), Errc::kTimeout);
  EXPECT_EQ(host->health().send_dropped, 1U);
}

TEST_F(SocketCan, bus_off_ends_sending_until_the_controller_was_restarted) {
  const auto bus = open();
  kernel_.report_error(CAN_ERR_BUSOFF);

  EXPECT_EQ(bus->receive(0ns).error(), Errc::kDisconnected);
  EXPECT_EQ(bus->health().state, BusState::kBusOff);
  EXPECT_EQ(bus->send(frame_of(1)).error(), Errc::kDisconnected);
  kernel_.report_error(CAN_ERR_RESTARTED);
  EXPECT_EQ(bus->receive(0ns).error(), Errc::kTimeout);
  EXPECT_TRUE(bus->send(frame_of(1)).ok());
}

TEST_F(SocketCan, every_kind_of_error_frame_has_its_counter_and_state) {
  const auto bus = open();
  kernel_.report_error(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING);
  (void)bus->receive(0ns);
  EXPECT_EQ(bus->health().state, BusState::kErrorWarning);
  kernel_.report_error(CAN_ERR_CRTL | CAN_ERR_ACK, CAN_ERR_CRTL_TX_PASSIVE);
  (void)bus->receive(0ns);
  EXPECT_EQ(bus->health().state, BusState::kErrorPassive);
  kernel_.report_error(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
  kernel_.report_error(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW);
  kernel_.report_error(CAN_ERR_TX_TIMEOUT | CAN_ERR_LOSTARB | CAN_ERR_PROT | CAN_ERR_TRX);
  kernel_.report_error(CAN_ERR_BUSERROR);
  (void)bus->receive(0ns);

  const auto counts = bus->error_counts();
  EXPECT_EQ(bus->health().state, BusState::kErrorActive);
  EXPECT_EQ(bus->health().error_frames, 6U);
  EXPECT_EQ(counts.controller, 4U);
  EXPECT_EQ(counts.controller_overflow, 1U);
  EXPECT_EQ(counts.no_ack, 1U);
  EXPECT_EQ(counts.tx_timeout, 1U);
  EXPECT_EQ(counts.lost_arbitration, 1U);
  EXPECT_EQ(counts.protocol, 1U);
  EXPECT_EQ(counts.transceiver, 1U);
  EXPECT_EQ(counts.bus_error, 1U);
}

TEST_F(SocketCan, frames_the_kernel_had_no_room_for_are_counted) {
  const auto host = open();
  const auto peer = open();
  kernel_.set_receive_room(3);
  for (int i = 0; i < 50; ++i) {
    (void)host->send(frame_of(1));
    (void)host->receive(0ns);
  }

  while (peer->receive(0ns).ok()) {
  }

  EXPECT_EQ(peer->health().received, 3U);
  EXPECT_EQ(peer->health().receive_overflow, 47U);
}

TEST_F(SocketCan, what_is_no_data_frame_is_counted_and_passed_over) {
  const auto bus = open();
  canfd_frame remote{};
  remote.can_id = 0x120 | CAN_RTR_FLAG;
  canfd_frame oversize{};
  oversize.len = 13;
  kernel_.inject(remote, CAN_MTU);
  kernel_.inject(oversize, CANFD_MTU);
  kernel_.inject({}, 5);
  canfd_frame good{};
  good.can_id = 0x123;
  kernel_.inject(good, CAN_MTU);

  const auto received = bus->receive(0ns);

  ASSERT_TRUE(received.ok());
  EXPECT_EQ(received.value().id, 0x123U);
  EXPECT_EQ(bus->health().malformed, 3U);
}

TEST_F(SocketCan, filters_let_only_the_link_through) {
  SocketCanBus::Config config;
  config.filters[0] = {0x120, 0x7F0};
  config.filter_count = 1;
  const auto bus = open(config);
  canfd_frame other{};
  other.can_id = 0x200;
  canfd_frame ours{};
  ours.can_id = 0x12F;
  kernel_.inject(other, CAN_MTU);
  kernel_.inject(ours, CAN_MTU);

  EXPECT_EQ(bus->receive(0ns).value().id, 0x12FU);
  EXPECT_EQ(bus->receive(0ns).error(), Errc::kTimeout);
}

TEST_F(SocketCan, a_flood_of_own_frames_does_not_hold_a_receive_for_long) {
  const auto bus = open();
  const int before = kernel_.calls();
  for (int i = 0; i < 100'000; ++i) {
    kernel_.inject({}, 5);
  }

  (void)bus->receive(0ns);

  EXPECT_LT(kernel_.calls() - before, 1000);
}

TEST_F(SocketCan, purge_without_a_hook_admits_that_the_kernel_still_holds_frames) {
  const auto bus = open();
  kernel_.set_stuck(true);
  ASSERT_TRUE(bus->send(frame_of(1)).ok());

  EXPECT_EQ(bus->purge().error(), Errc::kUnavailable);
}

TEST_F(SocketCan, purge_calls_the_hook_that_drops_what_the_kernel_holds) {
  SocketCanBus::Config config;
  config.purge_context = &kernel_;
  config.purge_hook = [](void* context) noexcept {
    static_cast<FakeKernel*>(context)->set_up(false);
    static_cast<FakeKernel*>(context)->set_up(true);
    return true;
  };
  const auto bus = open(config);
  const auto peer = open();
  kernel_.set_stuck(true);
  ASSERT_TRUE(bus->send(frame_of(1)).ok());

  EXPECT_TRUE(bus->purge().ok());

  kernel_.set_stuck(false);
  (void)peer->receive(0ns);
  kernel_.pass(200'000'000);
  EXPECT_EQ(peer->receive(0ns).error(), Errc::kTimeout);
}

}  // namespace
}  // namespace dseam::test
