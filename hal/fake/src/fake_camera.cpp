// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/fake/fake_camera.hpp"

#include <algorithm>
#include <utility>

#include "dseam/base/expects.hpp"
#include "dseam/depth/sample_layout.hpp"

namespace dseam::hal::fake {
namespace {

constexpr std::int64_t kHourNs = 3'600'000'000'000;
constexpr std::int64_t kDelayPeriods = 10;
constexpr std::int64_t kSlowdown = 4;

std::size_t frame_bytes(const depth::DepthModel& model) noexcept {
  return static_cast<std::size_t>(depth::depth_bytes(model) + depth::gray_bytes(model));
}

std::uint32_t slots_in(std::size_t pool_bytes, std::size_t frame) noexcept {
  return static_cast<std::uint32_t>(
      std::min<std::size_t>(SlotPool::kMaxSlots, frame == 0 ? 0 : pool_bytes / frame));
}

}  // namespace

std::size_t FakeCamera::pool_bytes(const depth::DepthModel& model, std::size_t frames) noexcept {
  return frames * frame_bytes(model);
}

FakeCamera::FakeCamera(const Setup& setup, Clock& clock) noexcept
    : setup_(setup), clock_(clock), slots_(slots_in(setup.pool.size(), frame_bytes(setup.model))) {
  DSEAM_EXPECTS(setup.depth.size() >= depth::depth_bytes(setup.model));
  DSEAM_EXPECTS(setup.gray.size() >= depth::gray_bytes(setup.model));
}

Result<> FakeCamera::do_start(FrameMode mode) noexcept {
  if (running_.exchange(true)) {
    return Errc::kUnavailable;
  }
  while (queued_ > 0) {
    slots_.give_back(take_oldest().slot);
  }
  mode_ = mode;
  due_ns_ = clock_.now_ns() + setup_.period_ns;
  return {};
}

void FakeCamera::do_stop() noexcept { running_ = false; }

Result<FrameLease> FakeCamera::do_next(std::chrono::nanoseconds timeout) noexcept {
  const std::int64_t deadline_ns = clock_.now_ns() + timeout.count();
  play_until(clock_.now_ns());
  while (running_ && queued_ == 0 && due_ns_ <= deadline_ns) {
    clock_.sleep_until(due_ns_);
    play_until(clock_.now_ns());
  }
  if (!running_) {
    return Errc::kUnavailable;
  }
  if (queued_ == 0) {
    clock_.sleep_until(deadline_ns);
    return unplugged_ ? Errc::kDisconnected : Errc::kTimeout;
  }
  while (mode_ == FrameMode::kLatest && queued_ > 1) {
    slots_.give_back(take_oldest().slot);
    ++counters_.skipped;
  }
  Waiting taken = take_oldest();
  taken.frame.dequeued_ns = clock_.now_ns();
  ++counters_.delivered;
  return FrameLease(*this, taken.frame, taken.slot);
}

void FakeCamera::play_until(std::int64_t now_ns) noexcept {
  while (running_ && due_ns_ <= now_ns) {
    play_one();
  }
}

void FakeCamera::play_one() noexcept {
  const FaultScript::Turn turn = script_.next();
  if (unplugged_ && turn.fault != DeviceFault::kUnplugged) {
    ++counters_.reconnects;
    sequence_.restart();
  }
  unplugged_ = turn.fault == DeviceFault::kUnplugged;
  const bool absent = unplugged_ || turn.fault == DeviceFault::kOff ||
                      (turn.fault == DeviceFault::kIntermittent && turn.index % 2 == 1);
  if (!absent) {
    expose(turn);
  }
  due_ns_ += turn.fault == DeviceFault::kSlow ? kSlowdown * setup_.period_ns : setup_.period_ns;
}

void FakeCamera::expose(FaultScript::Turn turn) noexcept {
  if (turn.fault != DeviceFault::kStuck) {
    ++device_count_;
  }
  if (turn.fault == DeviceFault::kClockJump && turn.index == 0) {
    clock_offset_ns_ += kHourNs;
  }
  if (turn.fault == DeviceFault::kLost) {
    return;
  }
  const FrameSequence::Step step = sequence_.advance(device_count_ & UINT32_MAX);
  missing_ += step.gap;
  counters_.lost += step.gap;
  if (turn.fault == DeviceFault::kWrong || turn.fault == DeviceFault::kTruncated) {
    lose(counters_.damaged);
    return;
  }
  const std::uint32_t slot = slots_.take();
  if (slot == SlotPool::kNone) {
    lose(counters_.underruns);
    return;
  }
  Waiting& waiting = queue_[queued_++];
  waiting.slot = slot;
  waiting.frame.sequence = step.sequence;
  waiting.frame.gap = std::exchange(missing_, 0U);
  fill(slot, turn.fault, waiting);
}

void FakeCamera::lose(CameraCounters::Counter& counter) noexcept {
  ++counter;
  ++missing_;
}

void FakeCamera::fill(std::uint32_t slot, DeviceFault fault, Waiting& out) noexcept {
  const std::size_t depth_bytes = static_cast<std::size_t>(depth::depth_bytes(setup_.model));
  const std::size_t gray_bytes = static_cast<std::size_t>(depth::gray_bytes(setup_.model));
  const auto memory = setup_.pool.subspan(slot * (depth_bytes + gray_bytes));
  const auto depth = memory.first(depth_bytes);
  const auto gray = memory.subspan(depth_bytes, gray_bytes);
  std::copy_n(setup_.depth.begin(), depth_bytes, depth.begin());
  std::copy_n(setup_.gray.begin(), gray_bytes, gray.begin());
  if (fault == DeviceFault::kGarbage) {
    std::generate(depth.begin(), depth.end(), [this] { return std::byte(random_.below(256)); });
    std::generate(gray.begin(), gray.end(), [this] { return std::byte(random_.below(256)); });
  }
  out.frame.depth = depth;
  out.frame.gray = gray;
  out.frame.captured_ns =
      fault == DeviceFault::kDelayed ? due_ns_ - kDelayPeriods * setup_.period_ns : due_ns_;
  out.frame.device_ns = out.frame.captured_ns + clock_offset_ns_;
  if (fault == DeviceFault::kStuck) {
    out.frame.device_ns = last_.device_ns;
    out.frame.captured_ns = last_.captured_ns;
  }
  last_ = out.frame;
}

FakeCamera::Waiting FakeCamera::take_oldest() noexcept {
  const Waiting oldest = queue_[0];
  --queued_;
  std::copy_n(queue_.begin() + 1, queued_, queue_.begin());
  return oldest;
}

}  // namespace dseam::hal::fake
