// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/random.hpp"
#include "dseam/hal/camera/camera_counters.hpp"
#include "dseam/hal/camera/frame_sequence.hpp"
#include "dseam/hal/camera/slot_pool.hpp"
#include "dseam/hal/clock.hpp"
#include "dseam/hal/depth_camera.hpp"
#include "dseam/hal/fake/device_fault.hpp"

namespace dseam::hal::fake {

/// A camera that plays a script of good and bad frames, in real or in virtual time.
///
/// Memory:  lent: `pool` is cut into slots of one frame each, at most SlotPool::kMaxSlots.
/// Context: as DepthCamera; no thread of its own.
class FakeCamera final : public DepthCamera {
 public:
  struct Setup {
    depth::DepthModel model;
    std::int64_t period_ns = 33'000'000;
    std::span<const std::byte> depth;  ///< What it sees, depth_bytes(model) of it.
    std::span<const std::byte> gray;   ///< gray_bytes(model).
    std::span<std::byte> pool;
  };

  /// Bytes of pool for so many frames.
  static std::size_t pool_bytes(const depth::DepthModel& model, std::size_t frames) noexcept;

  FakeCamera(const Setup& setup, Clock& clock) noexcept;

  /// Replaces what is left of the script. Context: no other call at the same time.
  void play(std::span<const FaultStep> steps) noexcept { script_ = FaultScript(steps); }
  [[nodiscard]] bool script_done() const noexcept { return script_.done(); }
  [[nodiscard]] std::uint32_t num_lent() const noexcept { return slots_.num_lent(); }

 private:
  struct Waiting {
    DepthFrame frame;
    std::uint32_t slot = SlotPool::kNone;
  };

  const depth::DepthModel& do_model() const noexcept override { return setup_.model; }
  Result<> do_start(FrameMode mode) noexcept override;
  Result<FrameLease> do_next(std::chrono::nanoseconds timeout) noexcept override;
  void do_stop() noexcept override;
  CameraHealth do_health() const noexcept override { return counters_.snapshot(); }
  void do_give_back(std::uint32_t slot) noexcept override { slots_.give_back(slot); }

  void play_until(std::int64_t now_ns) noexcept;
  void play_one() noexcept;
  void expose(FaultScript::Turn turn) noexcept;
  void fill(std::uint32_t slot, DeviceFault fault, Waiting& out) noexcept;
  void lose(CameraCounters::Counter& counter) noexcept;
  Waiting take_oldest() noexcept;

  Setup setup_;
  Clock& clock_;
  SlotPool slots_;
  FaultScript script_;
  FrameSequence sequence_{0, UINT32_MAX};
  Pcg32 random_{1};
  CameraCounters counters_;
  std::atomic<bool> running_{false};
  FrameMode mode_ = FrameMode::kEvery;
  bool unplugged_ = false;
  std::int64_t due_ns_ = 0;
  std::int64_t clock_offset_ns_ = 0;
  std::uint64_t device_count_ = 0;
  std::uint32_t missing_ = 0;
  DepthFrame last_;
  std::array<Waiting, SlotPool::kMaxSlots> queue_{};
  std::uint32_t queued_ = 0;
};

}  // namespace dseam::hal::fake
