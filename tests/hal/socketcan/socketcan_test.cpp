// SPDX-License-Identifier: Apache-2.0
// What the kernel does to hal/socketcan in the field, with what was measured as the script.
#include <cerrno>

#include "hal/socketcan/fake_bus_test.hpp"

namespace dseam::test {
namespace {

using hal::BusState;
using hal::socketcan::SocketCanBus;
using namespace std::chrono_literals;

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
