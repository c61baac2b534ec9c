// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "dseam/hal/camera/camera_counters.hpp"
#include "dseam/hal/camera/slot_pool.hpp"
#include "dseam/hal/clock.hpp"
#include "dseam/hal/depth_camera.hpp"
#include "dseam/hal/pose/standing_poses.hpp"
#include "dseam/hal/sim/cell.hpp"

namespace dseam::hal::sim {

/// The simulated cell's scanner: one frame at each of the robot's poses, in order.
///
/// All views are rendered at make(); after that nothing allocates. The robot waits at a view until
/// its frame was taken, so no frame is ever overtaken, whatever the mode.
class SimScanner final : public DepthCamera {
 public:
  struct Options {
    std::int64_t period_ns = 33'000'000;  ///< From one exposure to the next, at least.
    std::uint32_t num_buffers = 8;        ///< Frames that can be on loan at once.
    bool repeat = false;                  ///< Start again after the last view, for ever.
    /// With it the robot reports flange poses, otherwise those of the camera.
    std::optional<geometry::RigidTransform> T_flange_camera;
  };

  /// Renders every view of `cell`, on as many threads as there are cores.
  ///
  /// Memory:  views and buffers of width * height * 3 bytes each.
  /// Errors:  kInvalidArgument: no buffers, or over SlotPool::kMaxSlots.
  [[nodiscard]] static Result<std::unique_ptr<SimScanner>> make(const Cell& cell,
                                                                const Options& options,
                                                                Clock& clock);

  [[nodiscard]] RobotState& robot_state() noexcept { return robot_; }
  [[nodiscard]] std::size_t num_views() const noexcept { return frames_.size(); }

 private:
  using Bytes = std::vector<std::byte>;  ///< Depth, then gray.

  SimScanner(const Cell& cell, const Options& options, Clock& clock);

  const depth::DepthModel& do_model() const noexcept override { return model_; }
  Result<> do_start(FrameMode mode) noexcept override;
  Result<FrameLease> do_next(std::chrono::nanoseconds timeout) noexcept override;
  void do_stop() noexcept override { running_ = false; }
  CameraHealth do_health() const noexcept override { return counters_.snapshot(); }
  void do_give_back(std::uint32_t slot) noexcept override { slots_.give_back(slot); }

  [[nodiscard]] bool at_end() const noexcept {
    return !options_.repeat && exposed_ >= frames_.size();
  }
  [[nodiscard]] FrameLease expose(std::uint32_t slot) noexcept;
  void report_pose(std::size_t view, std::int64_t captured_ns) noexcept;

  Options options_;
  Clock& clock_;
  depth::DepthModel model_;
  std::vector<CellView> views_;
  std::vector<Bytes> frames_;
  std::vector<Bytes> buffers_;
  SlotPool slots_;
  StandingPoses robot_;
  CameraCounters counters_;
  std::atomic<bool> running_{false};
  std::uint64_t exposed_ = 0;
  std::int64_t due_ns_ = 0;
};

}  // namespace dseam::hal::sim
