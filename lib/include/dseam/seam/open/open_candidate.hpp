// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "dseam/seam/joint/ring_finder.hpp"
#include "dseam/seam/open/open_joint.hpp"
#include "dseam/seam/seam_report.hpp"

namespace dseam::seam {

/// An open seam that was found, and how well the cloud backs it.
struct OpenCandidate {
  OpenJoint joint;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double length_mm = 0.0;
  double coverage = 0.0;
  double score_mm = 0.0;  ///< Length that is backed, less where one side is narrow.
  RingFate fate = RingFate::kOutscored;
};

[[nodiscard]] inline bool contains(const RingHint& hint, const Eigen::Vector3d& p) noexcept {
  return !hint.has_region || ((p.array() >= hint.region_min.array()).all() &&
                              (p.array() <= hint.region_max.array()).all());
}

}  // namespace dseam::seam
