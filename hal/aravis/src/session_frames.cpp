// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "dseam/depth/sample_layout.hpp"
#include "session.hpp"

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
std::int64_t age_ns(ArvBuffer* buffer) noexcept {
  constexpr std::int64_t kOldestNs = 5'000'000'000;
  const auto arrived = static_cast<std::int64_t>(arv_buffer_get_system_timestamp(buffer));
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
    ArvBuffer* buffer = pop(deadline);
    if (buffer == nullptr) {
      continue;
    }
    count_gap(arv_buffer_get_frame_id(buffer));
    if (!is_whole(buffer)) {
      ++counters_.damaged;
      ++missing_;
      drop(buffer);
      continue;
    }
    slot = slot_of(buffer);
    ++counters_.delivered;
    return frame_of(buffer);
  } while (Clock::now() < deadline);
  const bool lost = state_ == AravisState::kLost;
  return !running_ ? Errc::kUnavailable : lost ? Errc::kDisconnected : Errc::kTimeout;
}

ArvBuffer* AravisCamera::Session::pop(Clock::time_point deadline) noexcept {
  constexpr std::chrono::nanoseconds kSlice = 10ms;
  const auto left = std::clamp(std::chrono::nanoseconds(deadline - Clock::now()), 0ns, kSlice);
  std::unique_lock lock(stream_mutex_);
  if (handing_over_ || stream_ == nullptr) {
    lock.unlock();
    std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(left, 1ms));
    return nullptr;
  }
  ArvBuffer* buffer =
      left > 0ns ? arv_stream_timeout_pop_buffer(stream_, static_cast<guint64>(left.count() / 1000))
                 : arv_stream_try_pop_buffer(stream_);
  if (buffer == nullptr) {
    return nullptr;
  }
  popped_[slot_of(buffer)] = buffer;
  return mode_ == FrameMode::kLatest ? newest(buffer) : buffer;
}

/// Under stream_mutex_. Overtaken frames go back; a damaged newer one does not hide a good one.
ArvBuffer* AravisCamera::Session::newest(ArvBuffer* oldest) noexcept {
  ArvBuffer* best = oldest;
  for (std::uint32_t i = 0; i < SlotPool::kMaxSlots; ++i) {
    ArvBuffer* newer = arv_stream_try_pop_buffer(stream_);
    if (newer == nullptr) {
      break;
    }
    popped_[slot_of(newer)] = newer;
    const bool replace = is_whole(newer) || !is_whole(best);
    ArvBuffer* overtaken = replace ? std::exchange(best, newer) : newer;
    count_gap(arv_buffer_get_frame_id(overtaken));
    ++(is_whole(overtaken) ? counters_.skipped : counters_.damaged);
    drop(overtaken);
  }
  return best;
}

bool AravisCamera::Session::is_whole(ArvBuffer* buffer) const noexcept {
  if (arv_buffer_get_status(buffer) != ARV_BUFFER_STATUS_SUCCESS) {
    return false;
  }
  std::size_t size = 0;
  (void)arv_buffer_get_data(buffer, &size);
  const ArvPixelFormat code = arv_buffer_get_image_pixel_format(buffer);
  const auto format = depth::format_from_pfnc(code);
  const bool as_agreed = config_.gray ? code == ARV_PIXEL_FORMAT_MONO_8
                                      : format.ok() && format.value() == model_.format;
  // Aravis' own fake reports no size at all.
  return (size == 0 || size >= image_bytes_) && as_agreed &&
         std::cmp_equal(arv_buffer_get_image_width(buffer), model_.intrinsics.width) &&
         std::cmp_equal(arv_buffer_get_image_height(buffer), model_.intrinsics.height);
}

DepthFrame AravisCamera::Session::frame_of(ArvBuffer* buffer) noexcept {
  DepthFrame frame;
  (config_.gray ? frame.gray : frame.depth) = {pool_.slot(slot_of(buffer)), pool_.payload_bytes()};
  frame.device_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer));
  frame.dequeued_ns = monotonic_ns();
  frame.captured_ns = std::max(last_captured_ns_, frame.dequeued_ns - age_ns(buffer));
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
