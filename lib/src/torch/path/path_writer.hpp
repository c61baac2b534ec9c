// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/base/buffer.hpp"
#include "dseam/torch/torch_path.hpp"

namespace dseam::torch {

/// What a stretch of path is written with.
struct Stroke {
  Segment segment = Segment::kApproach;
  double speed_mm_s = 1.0;
  bool arc = false;
  bool gas = false;
  bool wire = false;
  std::uint8_t pass = 0;
  std::uint8_t schedule = 0;
  seam::Confidence confidence = seam::Confidence::kHigh;
};

/// Appends path points and carries their length on. A stroke holds from a point to the next, so
/// the point at which a stroke ends is written by what comes after it.
class PathWriter {
 public:
  explicit PathWriter(Buffer<PathPoint>& out) noexcept : out_(out) { out.clear(); }

  [[nodiscard]] bool full() const noexcept { return full_; }
  [[nodiscard]] bool empty() const noexcept { return out_.empty(); }
  [[nodiscard]] const TorchPose& last() const noexcept { return out_[out_.size() - 1].pose; }

  /// A point `step_mm` of centre line after the one before.
  void move_to(const TorchPose& pose, double step_mm, const Stroke& stroke) noexcept;
  /// Stands at the last point's place: the stroke's arc, gas and wire hold for `dwell_s`.
  void stand(double dwell_s, const Stroke& stroke) noexcept;
  /// What is written from the last point on.
  void set_stroke(const Stroke& stroke) noexcept;
  /// In a straight line, the orientation turning evenly, to rest at `pose`.
  void line_to(const TorchPose& pose, double step_mm, const Stroke& stroke) noexcept;
  /// Makes the last point a stop.
  void stop() noexcept;

 private:
  void append(const TorchPose& pose, const Stroke& stroke) noexcept;

  Buffer<PathPoint>& out_;
  double s_mm_ = 0.0;
  bool full_ = false;
};

}  // namespace dseam::torch
