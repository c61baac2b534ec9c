// SPDX-License-Identifier: Apache-2.0
#include <poll.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <utility>

#include "dseam/depth/sample_layout.hpp"
#include "session.hpp"

// The consumer's side of a session: nothing here allocates, or blocks for more than a slice.

namespace dseam::hal::v4l2 {
namespace {

using namespace std::chrono_literals;

constexpr auto kSlice = 10ms;
constexpr std::uint32_t kMostQueueFailures = 8;

std::int64_t monotonic_ns() noexcept {
  return std::chrono::steady_clock::now().time_since_epoch().count();
}

std::int64_t stamp_ns(const v4l2_buffer& buffer) noexcept {
  return std::int64_t{buffer.timestamp.tv_sec} * 1'000'000'000 +
         std::int64_t{buffer.timestamp.tv_usec} * 1000;
}

/// The exposure in our time. A driver may stamp the end of a frame that it delivers early, so that
/// the stamp lies in the future; a stamp of another clock, or an absurd one, says nothing.
std::int64_t captured_ns(const v4l2_buffer& buffer, std::int64_t now_ns) noexcept {
  constexpr std::int64_t kOldestNs = 5'000'000'000;
  const std::int64_t age_ns = now_ns - stamp_ns(buffer);
  const bool monotonic =
      (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  return monotonic && age_ns > 0 && age_ns < kOldestNs ? now_ns - age_ns : now_ns;
}

}  // namespace

Result<DepthFrame> V4l2Camera::Session::next(std::chrono::nanoseconds timeout,
                                             std::uint32_t& slot) noexcept {
  const auto deadline = Clock::now() + timeout;
  do {
    if (!running_) {
      return Errc::kUnavailable;
    }
    const std::optional<Taken> taken = take(deadline);
    if (taken.has_value()) {
      slot = taken->slot;
      ++counters_.delivered;
      return taken->frame;
    }
    if (loss_unreported_.exchange(false)) {
      return Errc::kDisconnected;
    }
  } while (Clock::now() < deadline);
  const bool lost = state_ == V4l2State::kLost;
  return !running_ ? Errc::kUnavailable : lost ? Errc::kDisconnected : Errc::kTimeout;
}

std::optional<V4l2Camera::Session::Taken> V4l2Camera::Session::take(
    Clock::time_point deadline) noexcept {
  const auto left = std::clamp<Clock::duration>(deadline - Clock::now(), 0ns, kSlice);
  std::unique_lock lock(stream_mutex_);
  take_back_returned();
  if (claimed_ || !streaming_ || num_queued_ == 0) {
    const bool starved = streaming_ && num_queued_ == 0;
    counters_.underruns += starved && !std::exchange(starved_, starved) ? 1U : 0U;
    lock.unlock();
    std::this_thread::sleep_for(std::min<Clock::duration>(left, 1ms));
    return std::nullopt;
  }
  starved_ = false;
  const auto slice = std::chrono::duration_cast<std::chrono::milliseconds>(left);
  if (!wait_for_driver(static_cast<int>(slice.count()))) {
    return std::nullopt;
  }
  std::optional<Taken> taken = dequeue();
  if (taken.has_value() && mode_ == FrameMode::kLatest) {
    taken = newest(*taken);
  }
  if (taken.has_value()) {
    taken->frame = frame_of(*taken);
  }
  return taken;
}

/// True when there may be a frame, or an error that only dequeuing tells.
bool V4l2Camera::Session::wait_for_driver(int slice_ms) noexcept {
  const auto asked_at = Clock::now();
  const int events = stream_->wait(slice_ms);
  // Silence is what was waited for in vain: a consumer that was away is not the device's fault.
  silent_since_ = events == 0 ? std::min(silent_since_, asked_at) : Clock::time_point::max();
  const bool silent = events == 0 && Clock::now() - silent_since_ > config_.lost_after;
  if (events < 0 || silent) {
    fail();
    return false;
  }
  return events != 0;
}

/// A good frame, or nothing: bad ones are counted and given back to the driver.
std::optional<V4l2Camera::Session::Taken> V4l2Camera::Session::dequeue() noexcept {
  Taken taken{};
  const int error = stream_->dequeue(taken.buffer);
  if (error == -EAGAIN || error == -EINTR) {
    return std::nullopt;
  }
  const auto slot = std::find_if(slots_.begin(), slots_.end(), [&](const Slot& candidate) {
    return candidate.current && candidate.queued && candidate.index == taken.buffer.index;
  });
  if (error < 0 || slot == slots_.end()) {
    fail();
    return std::nullopt;
  }
  slot->queued = false;
  --num_queued_;
  count_gap(taken.buffer);
  if (!is_whole(taken.buffer)) {
    ++counters_.damaged;
    ++missing_;
    queue(*slot);
    return std::nullopt;
  }
  slot->lent = true;
  taken.slot = static_cast<std::uint32_t>(slot - slots_.begin());
  return taken;
}

V4l2Camera::Session::Taken V4l2Camera::Session::newest(Taken oldest) noexcept {
  for (std::uint32_t i = 0; i < SlotPool::kMaxSlots && num_queued_ > 0; ++i) {
    const std::optional<Taken> newer = dequeue();
    if (!newer.has_value()) {
      break;
    }
    take_back(oldest.slot);
    ++counters_.skipped;
    oldest = *newer;
  }
  return oldest;
}

bool V4l2Camera::Session::is_whole(const v4l2_buffer& buffer) const noexcept {
  return (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 && buffer.bytesused >= frame_bytes_ &&
         buffer.bytesused <= buffer.length;
}

void V4l2Camera::Session::count_gap(const v4l2_buffer& buffer) noexcept {
  const FrameSequence::Step step = sequence_.advance(buffer.sequence);
  missing_ += step.gap;
  counters_.lost += step.gap;
}

DepthFrame V4l2Camera::Session::frame_of(const Taken& taken) noexcept {
  const V4l2Sys::Mapping& mapping = slots_[taken.slot].mapping;
  DepthFrame frame;
  const std::span<const std::byte> bytes(
      mapping.start, std::min<std::size_t>(taken.buffer.bytesused, mapping.size_bytes));
  (config_.gray ? frame.gray : frame.depth) = bytes;
  frame.sequence = sequence_.current();
  frame.gap = std::exchange(missing_, 0U);
  frame.device_ns = stamp_ns(taken.buffer);
  frame.dequeued_ns = monotonic_ns();
  frame.captured_ns = std::max(last_captured_ns_, captured_ns(taken.buffer, frame.dequeued_ns));
  last_captured_ns_ = frame.captured_ns;
  return frame;
}

void V4l2Camera::Session::give_back(std::uint32_t slot) noexcept {
  returned_.fetch_or(1U << slot, std::memory_order_release);
}

void V4l2Camera::Session::take_back_returned() noexcept {
  std::uint32_t slots = returned_.exchange(0, std::memory_order_acquire);
  while (slots != 0) {
    take_back(static_cast<std::uint32_t>(std::countr_zero(slots)));
    slots &= slots - 1;
  }
}

/// A buffer of an earlier connection ends here; one of this connection goes to the driver.
void V4l2Camera::Session::take_back(std::uint32_t slot) noexcept {
  Slot& entry = slots_[slot];
  entry.lent = false;
  if (!entry.current) {
    (void)sys_.unmap(std::exchange(entry, Slot{}).mapping);
  } else if (streaming_) {
    queue(entry);
  }
}

void V4l2Camera::Session::queue(Slot& slot) noexcept {
  const int error = stream_->queue(slot.index);
  slot.queued = error >= 0;
  num_queued_ += slot.queued ? 1U : 0U;
  if (slot.queued) {
    queue_failures_ = 0;
  } else if (error == -ENODEV || ++queue_failures_ > kMostQueueFailures) {
    fail();
  } else {
    slot.lent = true;  // Tried again as if it had just come back.
    give_back(static_cast<std::uint32_t>(&slot - slots_.data()));
  }
}

/// The connection is of no more use; the control thread makes another.
void V4l2Camera::Session::fail() noexcept {
  streaming_ = false;
  state_ = V4l2State::kLost;
  failed_ = true;
  loss_unreported_ = true;
  wake_.notify_one();
}

}  // namespace dseam::hal::v4l2
