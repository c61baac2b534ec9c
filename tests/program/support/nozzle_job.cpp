// SPDX-License-Identifier: Apache-2.0
#include "program/support/nozzle_job.hpp"

#include <cmath>
#include <numbers>

namespace dseam::program::test {
namespace {

constexpr double kRadiusMm = 40.0;
constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

NozzleJob::NozzleJob() : views_(6) {
  add_surfaces();
  add_seam();
  add_path();
  for (splice::SplicedView& view : views_) {
    view.state = splice::ViewState::kUsed;
    view.num_markers = 9;
    view.marker_rms_mm = 0.02;
  }
  job.command = "weld";
  job.input = "simulated <camera> & robot";
  job.weld = true;
  job.reason = "100 % of the seam was measured";
  job.warnings = {"one warning"};
  job.stages = {{"decode", 41.0, {{"frames", 6}, {"pixels", 7512048}}}, {"splice", 120.5, {}}};
  job.budget = {{"scan", 0.02, "residuals"}, {"splice", 0.03, "covariance of the views"}};
  job.views = views_;
  job.cloud_base.points = {x_, y_, z_};
  job.seam_base = {seam_, kTurn * kRadiusMm, true, seam::ReferenceCurve::kShellEdge};
  job.path = path_;
  job.robot = {{"frames sent", "1200"}};
}

void NozzleJob::add_surfaces() {
  for (double u = -110.0; u < 110.0; u += 1.0) {
    for (double v = -110.0; v < 110.0; v += 1.0) {
      if (std::hypot(u, v) > kRadiusMm) {
        x_.push_back(static_cast<float>(u));
        y_.push_back(static_cast<float>(v));
        z_.push_back(0.0F);
      }
    }
  }
  for (double angle = 0.0; angle < kTurn; angle += 1.0 / kRadiusMm) {
    for (double height = 0.5; height < 60.0; height += 1.0) {
      x_.push_back(static_cast<float>(kRadiusMm * std::cos(angle)));
      y_.push_back(static_cast<float>(kRadiusMm * std::sin(angle)));
      z_.push_back(static_cast<float>(height));
    }
  }
  seam::JointReport& joint = job.seam_report.joint;
  joint.shell = {seam::SurfaceKind::kPlane, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()};
  joint.nozzle = {seam::SurfaceKind::kCylinder, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(),
                  kRadiusMm};
  job.seam_report.refusal = seam::Refusal::kNone;
  job.seam_report.closed = true;
  job.seam_report.length_mm = kTurn * kRadiusMm;
  job.seam_report.spacing_mm = 1.0;
  job.seam_report.num_candidates = 1;
  job.seam_report.candidates[0].fate = seam::RingFate::kChosen;
  job.seam_report.quality.coverage = 0.95;
}

void NozzleJob::add_seam() {
  for (double s_mm = 0.0; s_mm < kTurn * kRadiusMm - 0.25; s_mm += 0.5) {
    const double angle = s_mm / kRadiusMm;
    const Eigen::Vector3d outward(std::cos(angle), std::sin(angle), 0.0);
    seam::SeamPoint point;
    point.s_mm = s_mm;
    point.p_base = kRadiusMm * outward;
    point.tangent = {-outward.y(), outward.x(), 0.0};
    point.n_nozzle = outward;
    point.dihedral_rad = 0.5 * std::numbers::pi;
    point.sigma_lateral_mm = 0.02 + 0.005 * std::sin(3.0 * angle);
    point.sigma_normal_mm = 0.015;
    point.source =
        angle > 4.0 && angle < 4.3 ? seam::Source::kInterpolated : seam::Source::kMeasured;
    point.confidence = seam::Confidence::kHigh;
    seam_.push_back(point);
  }
}

void NozzleJob::add_path() {
  constexpr double kSpeed = 8.0;
  for (std::uint32_t i = 0; i < 3400; ++i) {
    const double s_mm = -15.0 + 0.01 * kSpeed * i;
    trajectory::SetPoint point;
    point.t_us = i * 10000;
    point.arc = s_mm > 0.0 && s_mm < kTurn * kRadiusMm;
    point.speed_mm_s = kSpeed;
    const double lift_mm = s_mm < 0.0 ? -s_mm : 0.0;
    point.pose.p_base = {kRadiusMm * std::cos(s_mm / kRadiusMm) + lift_mm,
                         kRadiusMm * std::sin(s_mm / kRadiusMm), lift_mm};
    path_.push_back(point);
  }
}

}  // namespace dseam::program::test
