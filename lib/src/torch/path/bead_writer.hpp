// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "../torch_curve.hpp"
#include "dseam/torch/path_planner.hpp"
#include "path_writer.hpp"

namespace dseam::torch {

/// A stretch of a pass to weld, in travel from the pass' start.
struct Bead {
  double begin_mm = 0.0;
  double end_mm = 0.0;
  double run_up_mm = 0.0;
};

/// Writes the beads of one path one after the other and keeps account of the wrist.
class BeadWriter {
 public:
  BeadWriter(const PathPlanner::Config& config, const TorchCurve& curve, const TorchPose* now,
             PathWriter& writer, PathPlanner::Report& report) noexcept
      : config_(config), curve_(curve), now_(now), writer_(writer), report_(report) {}

  void begin_pass(std::uint8_t index) noexcept;
  /// On the torch curve.
  [[nodiscard]] double pass_start_mm() const noexcept { return start_mm_; }
  void write(const Bead& bead) noexcept;

 private:
  /// The torch on the pass' centre line, `x_mm` from the pass' start.
  [[nodiscard]] TorchPose centre(double x_mm) const noexcept;
  [[nodiscard]] TorchPose woven(const TorchPose& pose, double x_mm) const noexcept;
  [[nodiscard]] TorchPose torch(double x_mm) const noexcept { return woven(centre(x_mm), x_mm); }
  [[nodiscard]] double from_mm() const noexcept { return bead_.begin_mm - bead_.run_up_mm; }
  [[nodiscard]] Stroke stroke(Segment segment, double speed_mm_s) const noexcept {
    return {segment, speed_mm_s, false, false, false, index_, pass_->schedule};
  }
  /// On the torch curve, `x_mm` from the pass' start.
  [[nodiscard]] TorchPoint seam_at(double x_mm) const noexcept {
    return curve_.at(start_mm_ + x_mm);
  }

  [[nodiscard]] std::uint8_t schedule_at(double s_mm) const noexcept;
  /// `s` with what belongs to that point of the seam.
  [[nodiscard]] Stroke over(const TorchPoint& point, Stroke s) const noexcept;

  [[nodiscard]] double bead_turn() const noexcept;
  [[nodiscard]] double wrist_after(double way_mm) const noexcept;
  [[nodiscard]] double way_to_next_bead() const noexcept;
  void note_wrist(double turn_rad) noexcept;

  void approach() noexcept;
  void transfer(const Stroke& air) noexcept;
  void lead_in() noexcept;
  void weld() noexcept;
  void along(double from, double to, const Stroke& s) noexcept;
  void finish() noexcept;

  const PathPlanner::Config& config_;
  const TorchCurve& curve_;
  const TorchPose* now_;
  PathWriter& writer_;
  PathPlanner::Report& report_;
  const Pass* pass_ = nullptr;
  std::uint8_t index_ = 0;
  double start_mm_ = 0.0;
  Bead bead_;
  double unwind_rad_ = 0.0;          ///< Taken out along the bead in hand,
  double unwound_before_rad_ = 0.0;  ///< and along the one before, to be given back in the air.
  double wrist_rad_ = 0.0;
  double at_mm_ = 0.0;  ///< Where on the curve the last bead ended.
};

/// `pose`, `height_mm` back along the wire.
[[nodiscard]] TorchPose lifted(const TorchPose& pose, double height_mm) noexcept;

}  // namespace dseam::torch
