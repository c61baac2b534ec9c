// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "session/session.hpp"

// The consumer's side of a session: nothing here allocates or makes a control call.

namespace dseam::hal::aravis {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kLast16BitId = 65535;

std::int64_t monotonic_ns() noexcept {
  return std::chrono::steady_clock::now().time_since_epoch().count();
}

std::int64_t wall_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::uint32_t slot_of(ArvBuffer* buffer) noexcept {
  return static_cast<std::uint32_t>(
      reinterpret_cast<std::uintptr_t>(arv_buffer_get_user_data(buffer)));  // NOLINT: Aravis' way.
}

/// How long ago the first packet came, by the wall clock; a clock that was set gives no age.
std::int64_t age_ns(const AravisSys::Arrival& arrival) noexcept {
  constexpr std::int64_t kOldestNs = 5'000'000'000;
  const auto arrived = static_cast<std::int64_t>(arrival.system_ns);
  const std::int64_t age = wall_ns() - arrived;
  return arrived > 0 && age > 0 && age < kOldestNs ? age : 0;
}

}  // namespace

Result<DepthFrame> AravisCamera::Session::next(std::chrono::nanoseconds timeout,
                                               std::uint32_t& slot) noexcept {
  const auto deadline = Clock::now() + timeout;
  do {
    if (!running_) {
      return Errc::kUnavailable;
    }
    if (loss_unreported_.exchange(false)) {
      return Errc::kDisconnected;
    }
    const Popped popped = pop(deadline);
    if (popped.buffer == nullptr) {
      continue;
    }
    count_gap(popped.arrival.frame_id);
    if (!popped.images.has_value()) {
      ++counters_.damaged;
      ++missing_;
      drop(popped.buffer);
      continue;
    }
    slot = slot_of(popped.buffer);
    ++counters_.delivered;
    return frame_of(popped);
  } while (Clock::now() < deadline);
  const bool lost = state_ == AravisState::kLost;
  return !running_ ? Errc::kUnavailable : lost ? Errc::kDisconnected : Errc::kTimeout;
}

AravisCamera::Session::Popped AravisCamera::Session::pop(Clock::time_point deadline) noexcept {
  constexpr std::chrono::nanoseconds kSlice = 10ms;
  const auto left = std::clamp(std::chrono::nanoseconds(deadline - Clock::now()), 0ns, kSlice);
  std::unique_lock lock(stream_mutex_);
  if (handing_over_ || stream_ == nullptr) {
    lock.unlock();
    std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(left, 1ms));
    return {};
  }
  ArvBuffer* buffer = sys_.pop(stream_, static_cast<std::uint64_t>(left.count() / 1000));
  if (buffer == nullptr) {
    return {};
  }
  const Popped popped = examine(buffer);
  return mode_ == FrameMode::kLatest ? newest(popped) : popped;
}

/// Under stream_mutex_. Overtaken frames go back; a damaged newer one does not hide a good one.
AravisCamera::Session::Popped AravisCamera::Session::newest(Popped oldest) noexcept {
  Popped best = oldest;
  for (std::uint32_t i = 0; i < SlotPool::kMaxSlots; ++i) {
    ArvBuffer* buffer = sys_.pop(stream_, 0);
    if (buffer == nullptr) {
      break;
    }
    const Popped newer = examine(buffer);
    const bool replace = newer.images.has_value() || !best.images.has_value();
    const Popped overtaken = replace ? std::exchange(best, newer) : newer;
    count_gap(overtaken.arrival.frame_id);
    ++(overtaken.images.has_value() ? counters_.skipped : counters_.damaged);
    drop(overtaken.buffer);
  }
  return best;
}

/// Takes the buffer from the stream's hands, and looks at what is in it.
AravisCamera::Session::Popped AravisCamera::Session::examine(ArvBuffer* buffer) noexcept {
  constexpr std::size_t kMostParts = 16;
  popped_[slot_of(buffer)] = buffer;
  Popped popped{buffer, sys_.arrival(buffer), std::nullopt};
  if (popped.arrival.status == ARV_BUFFER_STATUS_SUCCESS) {
    std::array<AravisSys::Part, kMostParts> parts;
    const std::size_t count = sys_.parts(buffer, parts);
    popped.images = pick_images(std::span(parts).first(count), wanted_);
  }
  return popped;
}

DepthFrame AravisCamera::Session::frame_of(const Popped& popped) noexcept {
  DepthFrame frame;
  frame.depth = popped.images->depth;
  frame.gray = popped.images->gray;
  frame.device_ns = static_cast<std::int64_t>(popped.arrival.device_ns);
  frame.dequeued_ns = monotonic_ns();
  frame.captured_ns = std::max(last_captured_ns_, frame.dequeued_ns - age_ns(popped.arrival));
  last_captured_ns_ = frame.captured_ns;
  frame.sequence = sequence_.current();
  frame.gap = std::exchange(missing_, 0U);
  return frame;
}

void AravisCamera::Session::drop(ArvBuffer* buffer) noexcept { give_back(slot_of(buffer)); }

void AravisCamera::Session::give_back(std::uint32_t slot) noexcept {
  returned_.fetch_or(1U << slot, std::memory_order_release);
  wake_.notify_one();
}

void AravisCamera::Session::count_gap(std::uint64_t frame_id) noexcept {
  if (reconnected_.exchange(false)) {
    sequence_.restart();
  }
  if (frame_id > kLast16BitId) {
    sequence_.widen(UINT64_MAX >> 1U);
  }
  const FrameSequence::Step step = sequence_.advance(frame_id);
  missing_ += step.gap;
  counters_.lost += step.gap;
}

}  // namespace dseam::hal::aravis
