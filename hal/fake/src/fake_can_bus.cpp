// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/fake/fake_can_bus.hpp"

#include <algorithm>

namespace dseam::hal::fake {
namespace {

constexpr std::int64_t kHourNs = 3'600'000'000'000;
constexpr std::int64_t kOldNs = 50'000'000;

}  // namespace

void FakeCanBus::join(FakeCanBus& other) noexcept {
  other_ = &other;
  other.other_ = this;
}

void FakeCanBus::set_state(BusState state) noexcept {
  health_.state = state;
  waiting_ = gone() ? 0 : waiting_;
}

Result<> FakeCanBus::do_send(const CanFrame& frame) noexcept {
  if (gone()) {
    return Errc::kDisconnected;
  }
  if (other_ != nullptr && other_->waiting_ == kInbox) {
    ++health_.send_dropped;
    return Errc::kQueueFull;
  }
  ++health_.sent;
  if (other_ != nullptr && !other_->gone()) {
    ++health_.confirmed;
    other_->arrive(frame);
  }
  return {};
}

void FakeCanBus::put(const CanFrame& frame) noexcept {
  if (waiting_ == kInbox) {
    ++health_.receive_overflow;
    return;
  }
  inbox_[(first_ + waiting_++) % kInbox] = frame;
}

void FakeCanBus::make_garbage(CanFrame& frame) noexcept {
  for (std::size_t i = 0; i < frame.size_bytes; ++i) {
    frame.data[i] = static_cast<std::byte>(random_.below(256));
  }
}

void FakeCanBus::arrive(const CanFrame& sent) noexcept {
  CanFrame frame = sent;
  frame.stamp_ns = clock_.now_ns();
  playing_ = playing_ && !script_.done();
  const FaultScript::Turn turn = playing_ ? script_.next() : FaultScript::Turn{DeviceFault::kNone};
  const CanFrame before = before_;
  before_ = frame;
  switch (turn.fault) {
    case DeviceFault::kOff:
    case DeviceFault::kLost:
      return;
    case DeviceFault::kSlow:
      return turn.index % 4 == 0 ? put(frame) : void();
    case DeviceFault::kIntermittent:
      return turn.index % 2 == 0 ? put(frame) : void();
    case DeviceFault::kUnplugged:
      return set_state(BusState::kDown);
    case DeviceFault::kStuck:
      frame = before;
      break;
    case DeviceFault::kGarbage:
      make_garbage(frame);
      break;
    case DeviceFault::kWrong:
      frame.id ^= 1U;
      break;
    case DeviceFault::kDelayed:
      frame.stamp_ns -= kOldNs;
      break;
    case DeviceFault::kTruncated:
      frame.size_bytes /= 2;
      break;
    case DeviceFault::kClockJump:
      frame.stamp_ns += kHourNs;
      break;
    case DeviceFault::kNone:
      break;
  }
  put(frame);
}

Result<CanFrame> FakeCanBus::do_receive(std::chrono::nanoseconds timeout) noexcept {
  if (gone()) {
    return Errc::kDisconnected;
  }
  if (waiting_ == 0) {
    clock_.sleep_until(clock_.now_ns() + timeout.count());
    return Errc::kTimeout;
  }
  const CanFrame frame = inbox_[first_];
  first_ = (first_ + 1) % kInbox;
  --waiting_;
  ++health_.received;
  return frame;
}

}  // namespace dseam::hal::fake
