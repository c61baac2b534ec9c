// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "dseam/seam/edge/edge_curve.hpp"
#include "dseam/seam/edge/unfollowed_error.hpp"
#include "dseam/seam/joint/joint_fit.hpp"
#include "dseam/seam/seam_curve.hpp"

namespace dseam::seam {

/// What is known beyond the fit and enters the predicted errors.
struct ErrorSources {
  double pose_sigma_mm = 0.0;      ///< Of both surfaces alike, because of the views' poses.
  double depth_sigma_mm = 0.0;     ///< Of all depths alike, what the scanner's calibration leaves.
  double hand_eye_sigma_mm = 0.0;  ///< 0: not known, left out.
  double hidden_gap_mm = 0.0;      ///< No edge was seen; a gap of up to this is not excluded.
  std::span<const Eigen::Vector3d> viewpoints{};  ///< Of the frames that edges were read in.
};

/// How well the points of a closed seam are known, across it and along the shell's normal.
///
/// Frame:   that of the fit, which must outlive this as the edges and the viewpoints.
/// Memory:  4 kB, in place.
/// Time:    O(views) a point, and two or three evaluations of the fit's covariance.
class PointErrors {
 public:
  /// `edges` has the one that the curve rests on; none where it rests on the surfaces alone.
  void reset(const JointFit& fit, const JointEdges& edges, const ErrorSources& sources) noexcept;
  /// One of several places evenly round the curve, before the first estimate.
  void add(double phi_rad, const Eigen::Vector3d& p) noexcept;
  /// Enters both sigmas of a point that is complete otherwise.
  void estimate(double phi_rad, SeamPoint& point) const noexcept;

 private:
  struct Variances {
    double lateral_mm2;
    double normal_mm2;
  };
  struct Crossing;

  [[nodiscard]] Variances of_surfaces(const SeamPoint& point, const Crossing& at) const noexcept;
  [[nodiscard]] Variances of_shell_edge(double phi_rad, const SeamPoint& point,
                                        const Crossing& at) const noexcept;
  [[nodiscard]] Variances of_nozzle_edge(double phi_rad, const SeamPoint& point,
                                         const Crossing& at) const noexcept;

  const JointFit* fit_ = nullptr;
  JointEdges edges_;
  ErrorSources sources_;
  UnfollowedError unfollowed_;
};

}  // namespace dseam::seam
