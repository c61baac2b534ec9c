// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "dseam/hal/camera/slot_pool.hpp"
#include "dseam/hal/depth_camera.hpp"

namespace dseam::hal {

/// A depth camera and a gray camera that see the same pixels, as one: two nodes of a V4L2 device,
/// or two sources on one trigger. Frames belong together by the time of their exposure.
///
/// Memory:  the two cameras' own; no frame is copied.
/// Context: as DepthCamera. The two cameras belong to it while it lives.
class PairedCamera final : public DepthCamera {
 public:
  /// `max_apart_ns`: exposures farther apart are of different moments.
  ///
  /// Errors:  kInvalidArgument: images of different sizes, a gray camera without gray.
  static Result<> check(const DepthCamera& depth, const DepthCamera& gray) noexcept {
    const depth::Intrinsics& a = depth.model().intrinsics;
    const depth::Intrinsics& b = gray.model().intrinsics;
    const bool fits = a.width == b.width && a.height == b.height && gray.model().has_gray;
    return fits ? Result<>() : Errc::kInvalidArgument;
  }
  /// Both must pass check().
  PairedCamera(DepthCamera& depth, DepthCamera& gray, std::int64_t max_apart_ns) noexcept
      : depth_(depth), gray_(gray), max_apart_ns_(max_apart_ns), model_(depth.model()) {
    model_.has_gray = true;
    model_.gray_row_stride_bytes = gray.model().gray_row_stride_bytes;
  }

 private:
  using Wait = std::chrono::steady_clock;

  /// The frames of one camera, one at a time, until it is matched or overtaken.
  struct Side {
    FrameLease lease;
    bool held = false;

    Result<> fetch(DepthCamera& camera, Wait::time_point until) noexcept {
      if (held) {
        return {};
      }
      const auto left = std::max(until - Wait::now(), Wait::duration::zero());
      Result<FrameLease> next = camera.next(left);
      if (!next.ok()) {
        return next.error();
      }
      lease = std::move(next.value());
      held = true;
      return {};
    }
    void drop() noexcept {
      lease = FrameLease();
      held = false;
    }
    [[nodiscard]] std::int64_t at_ns() const noexcept { return lease.frame().captured_ns; }
  };

  const depth::DepthModel& do_model() const noexcept override { return model_; }

  Result<> do_start(FrameMode mode) noexcept override {
    if (const Result<> started = depth_.start(mode); !started.ok()) {
      return started;
    }
    const Result<> started = gray_.start(mode);
    if (!started.ok()) {
      depth_.stop();
    }
    return started;
  }

  Result<FrameLease> do_next(std::chrono::nanoseconds timeout) noexcept override {
    const auto until = Wait::now() + timeout;
    for (int i = 0; i < kMostUnmatched; ++i) {
      if (const Result<> got = depth_side_.fetch(depth_, until); !got.ok()) {
        return got.error();
      }
      if (const Result<> got = gray_side_.fetch(gray_, until); !got.ok()) {
        return got.error();
      }
      const std::int64_t ahead_ns = gray_side_.at_ns() - depth_side_.at_ns();
      if (ahead_ns < -max_apart_ns_) {
        gray_side_.drop();
      } else if (ahead_ns > max_apart_ns_) {
        pass_over();
      } else {
        return pair();
      }
    }
    return Errc::kTimeout;
  }

  /// A depth frame for which there was no gray one.
  void pass_over() noexcept {
    missing_ += 1 + depth_side_.lease.frame().gap;
    ++unmatched_;
    depth_side_.drop();
  }

  Result<FrameLease> pair() noexcept {
    const std::uint32_t slot = slots_.take();
    if (slot == SlotPool::kNone) {
      return Errc::kTimeout;  // Every pair is on loan.
    }
    DepthFrame frame = depth_side_.lease.frame();
    frame.gray = gray_side_.lease.frame().gray;
    frame.gap += std::exchange(missing_, 0U);
    pairs_[slot] = {std::move(depth_side_.lease), std::move(gray_side_.lease)};
    depth_side_.held = false;
    gray_side_.held = false;
    return FrameLease(*this, frame, slot);
  }

  void do_stop() noexcept override {
    depth_.stop();
    gray_.stop();
    depth_side_.drop();
    gray_side_.drop();
  }

  CameraHealth do_health() const noexcept override {
    CameraHealth health = depth_.health();
    const CameraHealth gray = gray_.health();
    health.delivered -= unmatched_;
    health.lost += unmatched_;
    health.damaged += gray.damaged;
    health.underruns += gray.underruns;
    health.reconnects += gray.reconnects;
    return health;
  }

  void do_give_back(std::uint32_t slot) noexcept override {
    pairs_[slot] = {};
    slots_.give_back(slot);
  }

  static constexpr int kMostUnmatched = 64;

  DepthCamera& depth_;
  DepthCamera& gray_;
  std::int64_t max_apart_ns_;
  depth::DepthModel model_;
  Side depth_side_;
  Side gray_side_;
  std::array<std::pair<FrameLease, FrameLease>, SlotPool::kMaxSlots> pairs_;
  SlotPool slots_{SlotPool::kMaxSlots};
  std::uint32_t missing_ = 0;
  std::atomic<std::uint64_t> unmatched_{0};
};

}  // namespace dseam::hal
