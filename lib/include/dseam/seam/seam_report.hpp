// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/seam/seam_curve.hpp"
#include "dseam/seam/surface/surface.hpp"

namespace dseam::seam {

/// Why there is nothing to weld, or kNone.
enum class Refusal : std::uint8_t {
  kNone,
  kEmptyCloud,      ///< No finite point.
  kNotMillimetres,  ///< The whole part is smaller than a nozzle: metres, most likely.
  kCoplanar,        ///< All points lie in one plane: a plate, no nozzle.
  kOneSurface,      ///< One surface only; two must meet.
  kNoRing,         ///< Surfaces were found, but no two of them meet in a ring with a concave joint.
  kOutsideRegion,  ///< Rings were found, none of them in the region or of the radius asked for.
  kTwoRings,       ///< Two rings are equally good; `candidates` has both.
  kLowCoverage,    ///< Less of the ring was seen than `min_coverage`.
  kLargeHole,      ///< A stretch longer than `max_hole_rad` was not seen.
  kNoSuchReference,  ///< The joint does not have the reference curve that was asked for.
  kUncertain,        ///< The predicted sigma exceeds `max_sigma_mm` on the measured part.
  kFull,             ///< The output or a work buffer is too small for this seam.
  kNoSeam,           ///< An open seam was asked for; no two surfaces meet in one.
  kTwoSeams,         ///< Two open seams are equally good; `candidates` has both.
};

/// The name without its `k`, for reports.
[[nodiscard]] const char* name(Refusal refusal) noexcept;
[[nodiscard]] const char* name(SurfaceKind kind) noexcept;
/// True where other input is needed (exit code 3), false where the part was seen too badly (4).
[[nodiscard]] bool is_fault_of_input(Refusal refusal) noexcept;

/// Why a candidate ring is not the seam, or kChosen.
enum class RingFate : std::uint8_t {
  kChosen,
  kOutscored,    ///< A seam as well, but a shorter or less seen one.
  kEqual,        ///< As good as the best one.
  kConvex,       ///< The surfaces meet as at a rim or a bolt hole, with no room for a weld.
  kUnsupported,  ///< Too little of both surfaces near it.
  kOutsideRegion,
  kWrongRadius,
};
[[nodiscard]] const char* name(RingFate fate) noexcept;

/// A ring in which two of the surfaces meet.
struct RingCandidate {
  Eigen::Vector3d centre_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_base = Eigen::Vector3d::UnitZ();
  double radius_mm = 0.0;
  double coverage = 0.0;  ///< Share of the turn with both surfaces.
  double score_mm = 0.0;  ///< Length of the ring that is backed by both surfaces.
  RingFate fate = RingFate::kUnsupported;
  SurfaceKind shell = SurfaceKind::kPlane;
  SurfaceKind nozzle = SurfaceKind::kCylinder;
};

/// A stretch without measurement, as angles about the nozzle's axis in the direction of travel.
struct AngularHole {
  double start_rad = 0.0;
  double width_rad = 0.0;
};

struct ResidualStats {
  double rms_mm = 0.0;
  double p95_mm = 0.0;
  double max_mm = 0.0;
  std::uint32_t count = 0;
};

/// How well the seam is known.
///
/// Lateral residuals are across the seam along the shell, normal ones along the shell's normal:
/// a surface fit's R-squared hides the former.
struct SeamQuality {
  double coverage = 0.0;
  double largest_hole_rad = 0.0;
  double closure_mm = 0.0;  ///< Between the curve's end and its start.
  ResidualStats lateral;
  ResidualStats normal;
  double mean_sigma_lateral_mm = 0.0;
  double max_sigma_lateral_mm = 0.0;  ///< On the measured part.
  double mean_sigma_normal_mm = 0.0;
  double max_sigma_normal_mm = 0.0;
  std::array<std::uint32_t, 4> num_by_confidence{};  ///< Indexed by Confidence.
};

/// What the joint was found to be.
struct JointReport {
  Surface shell;
  Surface nozzle;
  double axes_angle_rad = 0.0;  ///< Between the nozzle's axis and the shell's axis or plane normal.
  double axes_offset_mm =
      0.0;                  ///< Distance of the axes; of the nozzle's axis from a sphere's centre.
  int shell_harmonics = 0;  ///< Order of the residual that the points justified.
  int nozzle_harmonics = 0;
  bool has_gap = false;        ///< The shell's edge was seen.
  double hidden_gap_mm = 0.0;  ///< It was not, and a gap of up to this is not excluded.
  double mean_gap_mm = 0.0;
  double max_gap_mm = 0.0;
  bool has_nozzle_edge = false;  ///< The nozzle's end was seen to stand off the shell.
  double mean_mismatch_mm = 0.0;
  double max_mismatch_mm = 0.0;
  std::uint32_t num_shell_points = 0;
  std::uint32_t num_nozzle_points = 0;
  std::uint32_t num_edge_intervals = 0;
};

/// Everything that finding the seam has to say, refused or not.
struct SeamReport {
  static constexpr std::size_t kMaxCandidates = 16;
  static constexpr std::size_t kMaxHoles = 16;

  Refusal refusal = Refusal::kEmptyCloud;
  ReferenceCurve reference = ReferenceCurve::kShellEdge;
  bool closed = false;
  double length_mm = 0.0;
  double end_sigma_mm = 0.0;  ///< Of an open seam's two ends, along it.
  double noise_mm = 0.0;      ///< Scatter of the cloud's points about their surface.
  double spacing_mm = 0.0;    ///< Of the cloud's points.
  std::uint32_t num_points = 0;
  std::uint32_t num_not_finite = 0;
  std::uint32_t num_surfaces = 0;
  std::uint32_t num_candidates = 0;
  std::uint32_t num_holes = 0;
  std::array<RingCandidate, kMaxCandidates> candidates{};  ///< Best first.
  std::array<AngularHole, kMaxHoles> holes{};
  JointReport joint;
  SeamQuality quality;

  [[nodiscard]] bool weld() const noexcept { return refusal == Refusal::kNone; }
};

/// The points and what the report says of them as one curve.
[[nodiscard]] inline SeamView view_of(std::span<const SeamPoint> points,
                                      const SeamReport& report) noexcept {
  return {points, report.length_mm, report.closed, report.reference};
}

}  // namespace dseam::seam
