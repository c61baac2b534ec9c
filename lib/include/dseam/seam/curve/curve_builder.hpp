// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "dseam/base/buffer.hpp"
#include "dseam/seam/curve/coverage.hpp"
#include "dseam/seam/curve/point_errors.hpp"
#include "dseam/seam/edge/edge_curve.hpp"
#include "dseam/seam/joint/joint_fit.hpp"
#include "dseam/seam/seam_curve.hpp"

namespace dseam::seam {

/// Walks once round a joint and writes the reference curve as evenly spaced points.
///
/// Frame:   that of the fit.
/// Memory:  about 61 kB: for an arena, not for a stack.
/// Time:    O(points), a few evaluations of the fitted surfaces each.
class CurveBuilder {
 public:
  struct Config {
    ReferenceCurve reference = ReferenceCurve::kShellEdge;
    double point_spacing_mm = 0.5;
    double start_angle_rad = 0.0;
    bool counter_clockwise = true;
  };
  struct Report {
    bool placed = false;  ///< False: the surfaces do not meet all round, or the output is full.
    bool full = false;
    double length_mm = 0.0;
    double closure_mm = 0.0;
  };

  Report run(const Config& config, const JointFit& fit, const JointEdges& edges,
             const RingCoverage& coverage, const ErrorSources& sources,
             Buffer<SeamPoint>& out) noexcept;

 private:
  static constexpr std::size_t kStations = 1024;

  [[nodiscard]] std::optional<Eigen::Vector3d> place(double phi_rad,
                                                     const Eigen::Vector3d& guess) const noexcept;
  [[nodiscard]] double angle_of(double turn_rad) const noexcept;
  [[nodiscard]] bool held_at(double phi_rad) const noexcept;
  [[nodiscard]] const EdgeCurve* edge_in_use() const noexcept;
  [[nodiscard]] double offset_at(double phi_rad) const noexcept;
  [[nodiscard]] double height_at(double phi_rad) const noexcept;
  bool measure_length() noexcept;
  void prepare_errors(const ErrorSources& sources) noexcept;
  SeamPoint point_at(double s_mm, const RingCoverage& coverage) const noexcept;

  Config config_;
  const JointFit* fit_ = nullptr;
  JointEdges edges_;
  std::array<Eigen::Vector3d, kStations> stations_;
  std::array<double, kStations + 1> lengths_{};
  PointErrors errors_;
};

}  // namespace dseam::seam
