// SPDX-License-Identifier: Apache-2.0
// What arrives at hal/socketcan: frames, errors, floods and nonsense.
#include <linux/can/error.h>

#include "hal/socketcan/fake_bus_test.hpp"

namespace dseam::test {
namespace {

using hal::BusState;
using hal::socketcan::SocketCanBus;
using namespace std::chrono_literals;

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

}  // namespace
}  // namespace dseam::test
