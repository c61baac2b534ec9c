// SPDX-License-Identifier: Apache-2.0
#include "rt/session/cell/virtual_bus.hpp"

#include <optional>

namespace dseam::test {
namespace {

constexpr std::int64_t kWireNs = 150'000;
constexpr std::size_t kInbox = 512;

void deliver(auto& way, std::int64_t now_ns) {
  while (!way.flying.empty() && way.flying.front().due_ns <= now_ns) {
    way.arrived.push_back(way.flying.front().frame);
    way.flying.pop_front();
  }
}

std::optional<hal::CanFrame> take(auto& way) {
  if (way.arrived.empty()) {
    return std::nullopt;
  }
  const hal::CanFrame frame = way.arrived.front();
  way.arrived.pop_front();
  return frame;
}

}  // namespace

void VirtualBus::advance(std::int64_t now_ns) {
  if (now_ns == now_ns_) {
    return;
  }
  now_ns_ = now_ns;
  deliver(to_robot_, now_ns);
  deliver(to_host_, now_ns);
  for (std::uint32_t i = 0; i < trouble.flood; ++i) {
    hal::CanFrame foreign;
    foreign.id = 0x10;
    foreign.extended = i % 2 == 0;
    foreign.size_bytes = 8;
    to_host_.arrived.push_back(foreign);
  }
  while (to_host_.arrived.size() > kInbox) {  // Like a socket's buffer: what is late is lost.
    to_host_.arrived.pop_back();
    ++overflow_;
  }
}

void VirtualBus::fly(hal::CanFrame frame, Way& way) {
  if (trouble.cut || trouble.state >= hal::BusState::kBusOff || happens(trouble.lose)) {
    injected += 1;
    return;
  }
  if (happens(trouble.corrupt) && frame.size_bytes > 0) {
    ++injected;
    const std::uint32_t bit = random_.below(8U * frame.size_bytes);
    frame.data[bit / 8] ^= std::byte{1} << (bit % 8);
  }
  if (!way.held && happens(trouble.reorder)) {
    way.held = frame;
    return;
  }
  const std::int64_t due_ns = now_ns_ + kWireNs + trouble.extra_delay_ns;
  way.flying.push_back({due_ns, frame});
  if (happens(trouble.duplicate)) {
    ++injected;
    way.flying.push_back({due_ns, frame});
  }
  const bool overtaken = way.held && way.held->id == frame.id;
  if (overtaken || (way.held && trouble.reorder <= 0.0)) {
    injected += overtaken ? 1U : 0U;
    way.flying.push_back({due_ns, *way.held});
    way.held.reset();
  }
}

void VirtualBus::robot_send(const hal::CanFrame& frame) { fly(frame, to_host_); }

bool VirtualBus::robot_receive(hal::CanFrame& frame) {
  const auto arrived = take(to_robot_);
  frame = arrived.value_or(frame);
  return arrived.has_value();
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
  const auto arrived = take(to_host_);
  return arrived ? Result<hal::CanFrame>(*arrived) : Errc::kTimeout;
}

Result<> VirtualBus::do_purge() noexcept {
  if (trouble.purge_fails) {
    return Errc::kIo;
  }
  to_robot_.flying.clear();
  to_robot_.held.reset();
  return {};
}

hal::BusHealth VirtualBus::do_health() const noexcept {
  hal::BusHealth health;
  health.state = trouble.state;
  health.receive_overflow = overflow_;
  return health;
}

}  // namespace dseam::test
