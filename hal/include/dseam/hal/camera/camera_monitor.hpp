// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdlib>

#include "dseam/base/result.hpp"
#include "dseam/hal/depth_camera.hpp"

namespace dseam::hal {

/// What a whole frame, or its absence, says of the camera. Only kGood may be used.
enum class CameraVerdict : std::uint8_t {
  kGood,
  kWaiting,     ///< No frame, and none was due yet.
  kSilent,      ///< No frame for longer than the limit.
  kLost,        ///< The device is gone.
  kStuck,       ///< The same exposure again and again.
  kStale,       ///< Older than the limit.
  kOutOfOrder,  ///< Exposed before the frame that came before it.
  kClockJump,   ///< The device's clock and ours moved differently.
};
inline constexpr std::uint8_t kNumCameraVerdicts = 8;

/// Judges every frame by its stamps: what a driver delivers as whole can still be of no use.
///
/// Context: the consumer's thread; real-time safe.
class CameraMonitor {
 public:
  struct Limits {
    std::int64_t period_ns = 33'333'333;
    std::int64_t max_age_ns = 200'000'000;
    std::int64_t max_clock_step_ns = 500'000'000;
    std::uint32_t silent_periods = 2;
    std::uint32_t stuck_frames = 3;
  };

  explicit constexpr CameraMonitor(const Limits& limits) noexcept : limits_(limits) {}

  /// The verdict on a frame that came at `now_ns`.
  CameraVerdict on_frame(const DepthFrame& frame, std::int64_t now_ns) noexcept {
    last_frame_ns_ = now_ns;
    const CameraVerdict verdict = any_ ? judge(frame, now_ns) : age_of(frame, now_ns);
    repeats_ = any_ && frame.device_ns == device_ns_ ? repeats_ + 1 : 0;
    // Also after a bad one: a clock that jumped once is right again from there on.
    any_ = true;
    device_ns_ = frame.device_ns;
    captured_ns_ = frame.captured_ns;
    return count(verdict);
  }

  /// The verdict when DepthCamera::next() gave none.
  CameraVerdict on_absence(Errc reason, std::int64_t now_ns) noexcept {
    if (!any_ && last_frame_ns_ == 0) {
      last_frame_ns_ = now_ns;
    }
    const std::int64_t limit_ns = std::int64_t{limits_.silent_periods} * limits_.period_ns;
    if (reason == Errc::kDisconnected) {
      return count(CameraVerdict::kLost);
    }
    return count(now_ns - last_frame_ns_ > limit_ns ? CameraVerdict::kSilent
                                                    : CameraVerdict::kWaiting);
  }

  [[nodiscard]] std::uint64_t counted(CameraVerdict verdict) const noexcept {
    return counts_[static_cast<std::uint8_t>(verdict)];
  }

 private:
  [[nodiscard]] CameraVerdict judge(const DepthFrame& frame, std::int64_t now_ns) const noexcept {
    const std::int64_t device_step_ns = frame.device_ns - device_ns_;
    const std::int64_t host_step_ns = frame.captured_ns - captured_ns_;
    if (device_step_ns == 0) {
      return repeats_ + 1 >= limits_.stuck_frames ? CameraVerdict::kStuck : CameraVerdict::kStale;
    }
    if (host_step_ns < 0) {
      return CameraVerdict::kOutOfOrder;
    }
    if (std::llabs(device_step_ns - host_step_ns) > limits_.max_clock_step_ns) {
      return CameraVerdict::kClockJump;
    }
    return age_of(frame, now_ns);
  }
  [[nodiscard]] CameraVerdict age_of(const DepthFrame& frame, std::int64_t now_ns) const noexcept {
    return now_ns - frame.captured_ns > limits_.max_age_ns ? CameraVerdict::kStale
                                                           : CameraVerdict::kGood;
  }
  CameraVerdict count(CameraVerdict verdict) noexcept {
    ++counts_[static_cast<std::uint8_t>(verdict)];
    return verdict;
  }

  Limits limits_;
  bool any_ = false;
  std::int64_t last_frame_ns_ = 0;
  std::int64_t device_ns_ = 0;
  std::int64_t captured_ns_ = 0;
  std::uint32_t repeats_ = 0;
  std::uint64_t counts_[kNumCameraVerdicts] = {};
};

}  // namespace dseam::hal
