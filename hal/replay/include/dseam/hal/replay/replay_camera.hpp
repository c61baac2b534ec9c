// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "dseam/hal/camera/camera_counters.hpp"
#include "dseam/hal/camera/slot_pool.hpp"
#include "dseam/hal/clock.hpp"
#include "dseam/hal/depth_camera.hpp"
#include "dseam/hal/pose/standing_poses.hpp"
#include "dseam/hal/replay/scan_set.hpp"

namespace dseam::hal::replay {

/// A scan set played as if its camera were there, with the poses of its robot.
///
/// Frames become due at the times of their stamps, or evenly where the set has none. In kEvery mode
/// they wait for the consumer; in kLatest mode they overtake each other as live frames do.
class ReplayCamera final : public DepthCamera {
 public:
  struct Options {
    double speed = 1.0;             ///< 2: twice as fast as it was recorded.
    bool step = false;              ///< No timing: each next() gives the following frame at once.
    bool repeat = false;            ///< Start again after the last frame, for ever.
    std::uint32_t num_buffers = 8;  ///< Frames that can be on loan at once.
    std::int64_t period_ns = 100'000'000;  ///< For sets without stamps.
    bool flange_poses = false;  ///< Report T_base_flange although T_base_camera is there too.
  };

  /// Errors:  a fault names the view: intrinsics, scale or gray that differ from the first view's,
  ///          stamps that do not rise; a speed or a number of buffers out of range.
  [[nodiscard]] static Loaded<std::unique_ptr<ReplayCamera>> make(ScanSet set,
                                                                  const Options& options,
                                                                  Clock& clock);

  /// The poses of the frames given so far, at their `captured_ns`; kNotFound for a view without.
  [[nodiscard]] RobotState& robot_state() noexcept { return robot_; }
  [[nodiscard]] std::size_t num_views() const noexcept { return set_.views.size(); }

 private:
  using Bytes = std::vector<std::byte>;  ///< Depth, then gray.

  ReplayCamera(ScanSet set, const Options& options, Clock& clock);

  const depth::DepthModel& do_model() const noexcept override { return model_; }
  Result<> do_start(FrameMode mode) noexcept override;
  Result<FrameLease> do_next(std::chrono::nanoseconds timeout) noexcept override;
  void do_stop() noexcept override { running_ = false; }
  CameraHealth do_health() const noexcept override { return counters_.snapshot(); }
  void do_give_back(std::uint32_t slot) noexcept override { slots_.give_back(slot); }

  [[nodiscard]] bool at_end(std::uint64_t frame) const noexcept {
    return !options_.repeat && frame >= set_.views.size();
  }
  /// The recording's own time of a frame, repeats included.
  [[nodiscard]] std::int64_t recorded_ns(std::uint64_t frame) const noexcept;
  /// When a frame becomes due on the host.
  [[nodiscard]] std::int64_t due_ns(std::uint64_t frame) const noexcept;
  void skip_overtaken() noexcept;
  [[nodiscard]] FrameLease expose(std::uint32_t slot) noexcept;
  void report_pose(const ViewCamera& camera, std::int64_t captured_ns) noexcept;

  ScanSet set_;
  Options options_;
  Clock& clock_;
  depth::DepthModel model_;
  std::vector<std::int64_t> stamps_ns_;  ///< From the first view's on.
  std::int64_t duration_ns_ = 0;         ///< One pass, the pause before the next included.
  std::vector<Bytes> buffers_;
  SlotPool slots_;
  StandingPoses robot_;
  CameraCounters counters_;
  std::atomic<bool> running_{false};
  FrameMode mode_ = FrameMode::kEvery;
  std::uint64_t next_frame_ = 0;
  std::uint64_t first_frame_ = 0;  ///< Next one at the last start.
  std::int64_t started_ns_ = 0;
  std::int64_t captured_ns_ = 0;  ///< Of the last frame.
};

}  // namespace dseam::hal::replay
