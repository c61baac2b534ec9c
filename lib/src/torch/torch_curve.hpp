// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "dseam/torch/torch_path.hpp"

namespace dseam::torch {

/// Reads a torch curve between its points; a closed one goes round as often as asked.
class TorchCurve {
 public:
  explicit TorchCurve(const TorchCurveView& view) noexcept : view_(view) {}

  [[nodiscard]] double length_mm() const noexcept { return view_.length_mm; }
  [[nodiscard]] bool closed() const noexcept { return view_.closed; }
  /// Distance of neighbouring points.
  [[nodiscard]] double spacing_mm() const noexcept;
  /// Between two points the torch; `weldable` and `confidence` are the worse of the two.
  [[nodiscard]] TorchPoint at(double s_mm) const noexcept;
  /// Turn about the wire on the way from one place to another, forward or backward.
  [[nodiscard]] double wrist_turn(double from_mm, double to_mm) const noexcept;

 private:
  [[nodiscard]] std::size_t num_segments() const noexcept {
    return view_.points.size() - (view_.closed ? 0 : 1);
  }
  TorchCurveView view_;
};

/// The turn about its own z that takes `a` to `b`.
[[nodiscard]] double turn_about_wire(const Eigen::Quaterniond& a,
                                     const Eigen::Quaterniond& b) noexcept;

}  // namespace dseam::torch
