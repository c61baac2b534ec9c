// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "dseam/base/buffer.hpp"
#include "dseam/seam/curve/point_errors.hpp"
#include "dseam/seam/open/open_sides.hpp"
#include "dseam/seam/seam_curve.hpp"

namespace dseam::seam {

/// Walks an open joint from end to end and writes the reference curve as evenly spaced points.
///
/// Fillet: `root` and `shell_edge` are where both sides meet, extended to each other; `nozzle_edge`
/// is the end of a plate that stands off the other, `gap_middle` half way to it. Butt: `root` and
/// `gap_middle` are half way between the plates' edges, `shell_edge` is that of the larger plate
/// and `nozzle_edge` that of the other.
///
/// Frame:   that of the sides.
/// Time:    O(points).
class OpenCurve {
 public:
  struct Config {
    ReferenceCurve reference = ReferenceCurve::kShellEdge;
    double point_spacing_mm = 0.5;
    bool second_side_left = true;  ///< Of the direction of travel, seen from the first side's air.
  };
  struct Report {
    bool placed = false;
    bool full = false;
    bool forward = true;  ///< Along the track.
    double length_mm = 0.0;
  };

  Report run(const Config& config, const OpenJoint& joint, const SeamTrack& track,
             const OpenSides& sides, const ErrorSources& errors, Buffer<SeamPoint>& out) noexcept;
  /// Whether the joint has that curve.
  [[nodiscard]] static bool has(ReferenceCurve reference, const OpenJoint& joint,
                                const OpenSides& sides) noexcept;

 private:
  /// Two places facing each other, and the variances of where they are.
  struct Section {
    Eigen::Vector3d first, second;
    double lateral_variance = 0.0;
    double normal_variance = 0.0;
  };

  [[nodiscard]] double start_of_travel() const noexcept;
  [[nodiscard]] double s_at(double travelled_mm) const noexcept;
  [[nodiscard]] std::optional<Eigen::Vector3d> meet(double s_mm, double raised_mm) const noexcept;
  [[nodiscard]] Eigen::Vector3d edge_of(std::size_t side, double s_mm) const noexcept;
  [[nodiscard]] std::optional<Eigen::Vector3d> place(double s_mm) const noexcept;
  void describe_opening(SeamPoint& point, double s_mm) const noexcept;
  void estimate_errors(SeamPoint& point, double s_mm, const ErrorSources& errors) const noexcept;
  [[nodiscard]] SeamPoint point_at(double travelled_mm, const ErrorSources& errors) const noexcept;

  Config config_;
  const OpenJoint* joint_ = nullptr;
  const SeamTrack* track_ = nullptr;
  const OpenSides* sides_ = nullptr;
  bool forward_ = true;
};

}  // namespace dseam::seam
