// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "dseam/base/result.hpp"
#include "dseam/depth/depth_model.hpp"

namespace dseam::hal {

/// One complete frame in the camera's own memory. Damaged frames are counted, never delivered.
struct DepthFrame {
  std::span<const std::byte> depth;  ///< Laid out as `DepthModel::format` says.
  std::span<const std::byte> gray;   ///< One byte a pixel, or empty.
  std::uint64_t sequence = 0;        ///< Rises by 1 + gap.
  std::uint32_t gap = 0;             ///< Frames lost between this one and the one before.
  std::int64_t device_ns = 0;        ///< The camera's own clock at exposure.
  std::int64_t captured_ns = 0;      ///< Monotonic host time of the exposure, as near as is known.
  std::int64_t dequeued_ns = 0;      ///< Monotonic host time when the frame was taken.
};

/// kLatest drains to the newest frame and counts what it skipped; kEvery loses none while the
/// pool lasts.
enum class FrameMode : std::uint8_t { kLatest, kEvery };

/// Counters since open; they only rise.
struct CameraHealth {
  std::uint64_t delivered = 0;
  std::uint64_t skipped = 0;    ///< Good, but overtaken in kLatest mode.
  std::uint64_t lost = 0;       ///< Gaps in the device's own sequence.
  std::uint64_t damaged = 0;    ///< Truncated, flagged, or of another size.
  std::uint64_t underruns = 0;  ///< The device found no free buffer.
  std::uint64_t reconnects = 0;
};

/// Whoever lends frames and takes them back; every DepthCamera is one.
class FrameLender {
 public:
  FrameLender() = default;
  FrameLender(const FrameLender&) = delete;
  FrameLender& operator=(const FrameLender&) = delete;

  /// Ends the loan of a slot; a FrameLease does it.
  void give_back(std::uint32_t slot) noexcept { do_give_back(slot); }

 protected:
  ~FrameLender() = default;

 private:
  virtual void do_give_back(std::uint32_t slot) noexcept = 0;
};

/// A frame on loan: the buffer goes back to the camera's pool when the lease ends.
///
/// Context: may be moved to another thread and ended there; wait-free.
class FrameLease {
 public:
  FrameLease() = default;
  FrameLease(FrameLender& owner, const DepthFrame& frame, std::uint32_t slot) noexcept
      : owner_(&owner), frame_(frame), slot_(slot) {}
  FrameLease(FrameLease&& other) noexcept { swap(other); }
  FrameLease& operator=(FrameLease&& other) noexcept {
    FrameLease(std::move(other)).swap(*this);
    return *this;
  }
  FrameLease(const FrameLease&) = delete;
  FrameLease& operator=(const FrameLease&) = delete;
  ~FrameLease() {
    if (owner_ != nullptr) {
      owner_->give_back(slot_);
    }
  }

  [[nodiscard]] const DepthFrame& frame() const noexcept { return frame_; }

 private:
  void swap(FrameLease& other) noexcept {
    std::swap(owner_, other.owner_);
    std::swap(frame_, other.frame_);
    std::swap(slot_, other.slot_);
  }

  FrameLender* owner_ = nullptr;
  DepthFrame frame_;
  std::uint32_t slot_ = 0;
};

/// One opened depth camera. Backends: hal/aravis, hal/v4l2, hal/replay, hal/sim, hal/fake.
/// `tests/contract/depth_camera_contract.hpp` holds every one of them to what is said here.
///
/// Context: start and stop from one control thread, next() from one consumer thread, also at the
///          same time; frame leases end on any thread.
class DepthCamera : public FrameLender {
 public:
  /// What the device granted at open; constant until it is opened again.
  [[nodiscard]] const depth::DepthModel& model() const noexcept { return do_model(); }
  /// Errors:  kUnavailable: started already. Else what the device says.
  Result<> start(FrameMode mode) noexcept { return do_start(mode); }
  /// Waits at most `timeout` for a complete frame; zero polls.
  ///
  /// Errors:  kTimeout: none came. kDisconnected: gone, reconnecting by itself where it can.
  ///          kNotFound: a recording is at its end. kUnavailable: not started.
  Result<FrameLease> next(std::chrono::nanoseconds timeout) noexcept { return do_next(timeout); }
  /// Idempotent; returns within 100 ms in every state. Leases that are still out stay readable
  /// until the next start().
  void stop() noexcept { do_stop(); }
  [[nodiscard]] CameraHealth health() const noexcept { return do_health(); }

 protected:
  ~DepthCamera() =
      default;  // Owners hold the concrete type: no delete, so no heap, through a base.

 private:
  [[nodiscard]] virtual const depth::DepthModel& do_model() const noexcept = 0;
  virtual Result<> do_start(FrameMode mode) noexcept = 0;
  virtual Result<FrameLease> do_next(std::chrono::nanoseconds timeout) noexcept = 0;
  virtual void do_stop() noexcept = 0;
  [[nodiscard]] virtual CameraHealth do_health() const noexcept = 0;
};

}  // namespace dseam::hal
