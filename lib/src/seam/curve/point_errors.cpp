// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/curve/point_errors.hpp"

#include <algorithm>
#include <cmath>

#include "dseam/seam/curve/mean_sight.hpp"

namespace dseam::seam {
namespace {

double square(double x) noexcept { return x * x; }

}  // namespace

// How the two surfaces cross at a point, and how it is looked at.
struct PointErrors::Crossing {
  double cosine;  // Of the angle between the normals.
  double sine_squared;
  MeanSight sight;
};

void PointErrors::reset(const JointFit& fit, const JointEdges& edges,
                        const ErrorSources& sources) noexcept {
  fit_ = &fit;
  edges_ = edges;
  sources_ = sources;
  unfollowed_.reset(edges.shell == nullptr ? 0 : edges.shell->order());
}

void PointErrors::add(double phi_rad, const Eigen::Vector3d& p) noexcept {
  if (edges_.shell != nullptr) {
    unfollowed_.add(phi_rad, fit_->nozzle_errors(p));
  }
}

void PointErrors::estimate(double phi_rad, SeamPoint& point) const noexcept {
  const double cosine = point.n_shell.dot(point.n_nozzle);
  const Crossing at{cosine, std::max(1e-3, 1.0 - square(cosine)),
                    mean_sight(sources_.viewpoints, point)};
  const Variances of = edges_.shell != nullptr    ? of_shell_edge(phi_rad, point, at)
                       : edges_.nozzle != nullptr ? of_nozzle_edge(phi_rad, point, at)
                                                  : of_surfaces(point, at);
  const double common = square(sources_.pose_sigma_mm) + square(sources_.hand_eye_sigma_mm);
  point.sigma_lateral_mm =
      std::sqrt(of.lateral_mm2 + common + square(sources_.depth_sigma_mm * at.sight.lateral));
  point.sigma_normal_mm =
      std::sqrt(of.normal_mm2 + common + square(sources_.depth_sigma_mm * at.sight.normal));
}

// Where the two surfaces meet is displaced by both. A gap of unknown width is as likely to be
// anything up to its bound.
PointErrors::Variances PointErrors::of_surfaces(const SeamPoint& point,
                                                const Crossing& at) const noexcept {
  const double shell = fit_->shell_variance(point.p_base);
  const double nozzle = fit_->nozzle_variance(point.p_base);
  return {(nozzle + square(at.cosine) * shell) / at.sine_squared +
              square(sources_.hidden_gap_mm) / 12.0,
          shell};
}

// The edge's distance from the nozzle was measured, so that most of the nozzle's own error does not
// count, and none of it that the edge's curve would have shown. But its pixels were put on the
// fitted shell along their rays, aslant.
PointErrors::Variances PointErrors::of_shell_edge(double phi_rad, const SeamPoint& point,
                                                  const Crossing& at) const noexcept {
  const double shell = fit_->shell_variance(point.p_base);
  const double unfollowed =
      std::min(unfollowed_.variance_at(phi_rad, fit_->nozzle_errors(point.p_base)),
               edges_.shell->unnoticed_variance_at(phi_rad));
  const double slant_squared =
      sources_.viewpoints.empty() ? square(at.cosine) / at.sine_squared : square(at.sight.slant());
  return {unfollowed / at.sine_squared + edges_.shell->variance_at(phi_rad) + slant_squared * shell,
          shell};
}

PointErrors::Variances PointErrors::of_nozzle_edge(double phi_rad, const SeamPoint& point,
                                                   const Crossing& at) const noexcept {
  const double height = fit_->shell_variance(point.p_base) + edges_.nozzle->variance_at(phi_rad);
  return {(fit_->nozzle_variance(point.p_base) + square(at.cosine) * height) / at.sine_squared,
          height};
}

}  // namespace dseam::seam
