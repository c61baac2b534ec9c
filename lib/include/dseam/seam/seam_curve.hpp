// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

namespace dseam::seam {

/// Which curve of the joint is meant. `docs/architecture.md` has the drawing.
enum class ReferenceCurve : std::uint8_t {
  kShellEdge,   ///< Outer shell surface met by the hole's wall; equals kRoot without a gap.
  kRoot,        ///< Outer shell met by outer nozzle, extended to each other.
  kGapMiddle,   ///< Midpoint of the two in the plane normal to the tangent.
  kNozzleEdge,  ///< The nozzle's edge that faces the shell.
};

enum class Confidence : std::uint8_t { kNone, kLow, kMedium, kHigh };

/// Whether raw points of both surfaces lie near this point, or the curve only bridges it.
enum class Source : std::uint8_t { kMeasured, kInterpolated };

/// One point of the seam, on the reference curve.
///
/// Frame:   base.
/// Units:   mm and rad.
struct SeamPoint {
  double s_mm = 0.0;  ///< Arc length from the first point.
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();
  Eigen::Vector3d n_shell = Eigen::Vector3d::UnitZ();   ///< Outward normal of the shell (n1).
  Eigen::Vector3d n_nozzle = Eigen::Vector3d::UnitX();  ///< Outward normal of the nozzle (n2).
  double dihedral_rad = 0.0;      ///< pi minus the angle between the normals, on the weld side.
  double sigma_lateral_mm = 0.0;  ///< Along the shell, across the seam; one standard deviation.
  double sigma_normal_mm = 0.0;   ///< Along the shell's normal.
  double gap_mm = 0.0;            ///< Along the shell from its edge to the nozzle; 0: they touch.
  double mismatch_mm = 0.0;       ///< Of the nozzle's edge above the shell; 0 where it has none.
  Confidence confidence = Confidence::kNone;
  Source source = Source::kInterpolated;
};

/// A seam by reference: ordered, in the direction of travel.
///
/// Shape:   closed curves do not repeat the first point; the segment from the last to the first
///          has the length `length_mm - points.back().s_mm`.
struct SeamView {
  std::span<const SeamPoint> points;
  double length_mm = 0.0;
  bool closed = true;
  ReferenceCurve reference = ReferenceCurve::kShellEdge;
};

}  // namespace dseam::seam
