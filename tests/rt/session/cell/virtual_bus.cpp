// SPDX-License-Identifier: Apache-2.0
#include "rt/session/cell/virtual_bus.hpp"

#include <utility>

namespace dseam::test {
namespace {

constexpr std::int64_t kWireNs = 150'000;
constexpr std::size_t kInbox = 512;

void deliver(auto& way, auto& inbox, std::int64_t now_ns) {
  while (!way.empty() && way.front().due_ns <= now_ns) {
    inbox.push_back(way.front().frame);
    way.pop_front();
  }
}

}  // namespace

void VirtualBus::advance(std::int64_t now_ns) {
  now_ns_ = now_ns;
  deliver(to_robot_, at_robot_, now_ns);
  deliver(to_host_, at_host_, now_ns);
  for (std::uint32_t i = 0; i < trouble.flood; ++i) {
    hal::CanFrame foreign;
    foreign.id = 0x10;
    foreign.extended = i % 2 == 0;
    foreign.size_bytes = 8;
    at_host_.push_back(foreign);
  }
  while (at_host_.size() > kInbox) {  // Like a socket's buffer: what comes too late is lost.
    at_host_.pop_back();
    ++overflow_;
  }
}

void VirtualBus::fly(const hal::CanFrame& frame, std::deque<Flying>& way) {
  if (trouble.cut || trouble.state >= hal::BusState::kBusOff || happens(trouble.lose)) {
    injected += 1;
    return;
  }
  Flying flying{now_ns_ + kWireNs + trouble.extra_delay_ns, frame};
  if (happens(trouble.corrupt) && frame.size_bytes > 0) {
    ++injected;
    const std::uint32_t bit = random_.below(8U * frame.size_bytes);
    flying.frame.data[bit / 8] ^= std::byte{1} << (bit % 8);
  }
  way.push_back(flying);
  if (happens(trouble.duplicate)) {
    ++injected;
    way.push_back(flying);
  }
  if (way.size() > 1 && happens(trouble.reorder)) {
    ++injected;
    std::swap(way[way.size() - 1].frame, way[way.size() - 2].frame);
  }
}

void VirtualBus::robot_send(const hal::CanFrame& frame) { fly(frame, to_host_); }

bool VirtualBus::robot_receive(hal::CanFrame& frame) {
  if (at_robot_.empty()) {
    return false;
  }
  frame = at_robot_.front();
  at_robot_.pop_front();
  return true;
}

Result<> VirtualBus::do_send(const hal::CanFrame& frame) noexcept {
  if (trouble.state >= hal::BusState::kBusOff) {
    return Errc::kDisconnected;
  }
  if (trouble.blocked) {
    return Errc::kQueueFull;
  }
  sent_this_cycle.push_back(frame);
  fly(frame, to_robot_);
  return {};
}

Result<hal::CanFrame> VirtualBus::do_receive(std::chrono::nanoseconds) noexcept {
  if (at_host_.empty()) {
    return Errc::kTimeout;
  }
  const hal::CanFrame frame = at_host_.front();
  at_host_.pop_front();
  return frame;
}

Result<> VirtualBus::do_purge() noexcept {
  if (trouble.purge_fails) {
    return Errc::kIo;
  }
  to_robot_.clear();
  return {};
}

hal::BusHealth VirtualBus::do_health() const noexcept {
  hal::BusHealth health;
  health.state = trouble.state;
  health.receive_overflow = overflow_;
  return health;
}

}  // namespace dseam::test
