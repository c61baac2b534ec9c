// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/torch/torch_path.hpp"
#include "dseam/torch/weave.hpp"

namespace dseam::torch {

/// One run round the joint.
struct Pass {
  double speed_mm_s = 8.0;
  double across_mm = 0.0;        ///< Offset in the joint's frame: sideways,
  double out_mm = 0.0;           ///< and away from the root.
  double work_offset_rad = 0.0;  ///< Turned about the tangent, towards the nozzle.
  double start_shift_mm = 0.0;   ///< Start past that of the first pass.
  Weave weave;
  std::uint8_t schedule = 0;         ///< Row of the welding parameter table,
  std::uint8_t crater_schedule = 0;  ///< and the one that fills the crater.
};

/// An arc of the loop on which a pass has welding parameters of its own: flat, uphill, overhead.
struct Sector {
  double from_mm = 0.0;  ///< Arc length on the torch curve;
  double to_mm = 0.0;    ///< less than `from_mm` where it leads over the curve's first point.
  std::uint8_t pass = 0;
  std::uint8_t schedule = 0;
};

/// What lies before the torch when it takes up a bead that was broken off.
struct Resume {
  bool active = false;
  std::uint8_t pass = 0;    ///< Passes before this one are done.
  double stopped_mm = 0.0;  ///< Arc length from the pass' start at which the arc went off.
  double run_up_mm = 10.0;  ///< Travel without arc before the torch strikes again,
  double overlap_mm = 5.0;  ///< which it does this far before the stop.
};

/// Lays the whole path over a torch curve: approach, lead-in, weld, overlap, crater, lead-out and
/// retract, for each pass and each stretch that may be welded.
///
/// Stretches that are not weldable are passed by on the retracted curve with the arc off, so that
/// the torch never cuts across the nozzle.
///
/// Frame:   base.
/// Memory:  none of its own.
/// Time:    O(points written).
/// Context: one thread at a time; no heap, lock or system call.
class PathPlanner {
 public:
  static constexpr std::size_t kMaxPasses = 8;
  static constexpr std::size_t kMaxSectors = 16;
  struct Config {
    std::array<Pass, kMaxPasses> passes{};
    std::uint8_t num_passes = 1;
    std::array<Sector, kMaxSectors> sectors{};  ///< Elsewhere the pass' own schedule holds.
    std::uint8_t num_sectors = 0;
    double start_mm = 0.0;      ///< Arc length of the start on the torch curve.
    double overlap_mm = 10.0;   ///< Past the start, on closed curves,
    double overlap_rad = 0.0;   ///< or this share of a turn when it is greater than zero.
    double approach_mm = 50.0;  ///< Height of approach and retract, along the wire,
    double lead_in_mm = 5.0;    ///< of which the last part is slow.
    double step_mm = 0.5;
    double travel_mm_s = 100.0;
    double lead_mm_s = 20.0;
    double preflow_s = 0.3;
    double ignition_s = 0.2;
    double crater_s = 0.5;
    double postflow_s = 0.5;
    double min_bead_mm = 10.0;     ///< Shorter weldable stretches are left out.
    double max_start_mm = 2000.0;  ///< A start pose farther away is refused.
    double max_wrist_turn_rad = 2.0 * std::numbers::pi;
    Resume resume;
  };
  enum class State : std::uint8_t {
    kPlanned,
    kNoCurve,          ///< No torch points, or no length.
    kNothingWeldable,  ///< No stretch of at least min_bead_mm.
    kStartTooFar,      ///< Or the start pose is not finite.
    kNothingLeft,      ///< The resume point lies past the last bead.
    kFull,             ///< The output is too small; it is left empty.
  };
  struct Report {
    State state = State::kNoCurve;
    std::uint32_t points = 0;
    std::uint32_t beads = 0;
    double weld_mm = 0.0;         ///< Travel with the arc on.
    double skipped_mm = 0.0;      ///< Of the passes' length, not weldable.
    double wrist_turn_rad = 0.0;  ///< Greatest turn about the wire from the first bead's start.
    double unwound_rad = 0.0;     ///< Turn about the wire that was taken out to keep the limit.
  };

  /// Errors:  kInvalidArgument: a value that is not finite or out of range.
  [[nodiscard]] static Result<PathPlanner> make(const Config& config) noexcept;

  /// Starts at the approach point of the first bead.
  Report run(const TorchCurveView& curve, Buffer<PathPoint>& out) noexcept;
  /// Starts where the torch is now.
  Report run_from(const TorchPose& now, const TorchCurveView& curve,
                  Buffer<PathPoint>& out) noexcept;

 private:
  explicit PathPlanner(const Config& config) noexcept : config_(config) {}
  bool is_near(const TorchPose& now, const TorchCurveView& view) const noexcept;
  Report plan(const TorchPose* now, const TorchCurveView& curve, Buffer<PathPoint>& out) noexcept;

  Config config_;
};

}  // namespace dseam::torch
