// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/pipes/pipe_placer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dseam/geometry/symmetric_matrix.hpp"
#include "splice/network/network_ties.hpp"

namespace dseam::splice {
namespace {

using geometry::Matrix6;
using geometry::RigidTransform;
using geometry::Vector6;

// From a left perturbation about the partner's camera to one about the base origin.
Matrix6 in_base(const Matrix6& covariance, const RigidTransform& T_base_a) noexcept {
  Matrix6 to_base = Matrix6::Zero();
  to_base.topLeftCorner<3, 3>() = T_base_a.rotation;
  to_base.topRightCorner<3, 3>() = geometry::skew(T_base_a.translation_mm) * T_base_a.rotation;
  to_base.bottomRightCorner<3, 3>() = T_base_a.rotation;
  return to_base * covariance * to_base.transpose();
}

}  // namespace

/// One place of a view, and what speaks for it.
struct PipePlacer::Candidate {
  RigidTransform T_base_camera;
  Report report;
  bool possible = false;  // Nothing rules it out,
  bool holds = false;     // and the surfaces say so.
};

bool PipePlacer::contradicted(const LiveSplicer::Report& live) const noexcept {
  return live.state == LiveSplicer::State::kContradicts ||
         live.share_before > config_.max_share_before;
}

bool PipePlacer::is_near(const RigidTransform& T_base_camera,
                         const ReportedPose& reported) const noexcept {
  const RigidTransform off = reported.T_base_camera.inverse() * T_base_camera;
  return reported.known && off.translation_mm.norm() < config_.report_gate_mm &&
         geometry::rotation_log(off.rotation).norm() < config_.report_gate_rad;
}

namespace {

// The report's share in the start, by both covariances; none where they contradict each other. The
// partner's own place hangs on a report as well.
void weigh_report(const ReportedPose& reported, const PipePlacer::Config& config,
                  RigidTransform& T_base_camera, PipePlacer::Report& report) noexcept {
  if (!reported.known) {
    return;
  }
  Matrix6 to_camera = Matrix6::Identity();
  to_camera.topRightCorner<3, 3>() = -geometry::skew(T_base_camera.translation_mm);
  Vector6 variance;
  variance.head<3>().setConstant(2.0 * config.reported_sigma_mm * config.reported_sigma_mm);
  variance.tail<3>().setConstant(2.0 * config.reported_sigma_rad * config.reported_sigma_rad);
  Vector6 off;
  off << reported.T_base_camera.translation_mm - T_base_camera.translation_mm,
      geometry::rotation_log(reported.T_base_camera.rotation * T_base_camera.rotation.transpose());
  const Matrix6 known = report.covariance * to_camera.transpose();
  Matrix6 sum = to_camera * known;
  sum.diagonal() += variance;
  const Vector6 weighed = geometry::inverse_of_symmetric<6>(sum) * off;
  report.report_chi_squared = off.dot(weighed);
  report.report_far_off = report.report_chi_squared > kReportedChiSquaredLimit;
  if (!report.report_far_off) {
    T_base_camera = geometry::perturbed(T_base_camera, known * weighed);
  }
}

}  // namespace

PipePlacer::Candidate PipePlacer::candidate(const PosedView& view, const PosedView& partner,
                                            const PipePlace& place, const ReportedPose& reported,
                                            std::span<const PosedView> others,
                                            const Eigen::Vector3d& shell_camera) const noexcept {
  Candidate out;
  out.T_base_camera = partner.T_base_camera * place.T_a_b;
  out.report.covariance = in_base(place.covariance, partner.T_base_camera);
  RigidTransform start = out.T_base_camera;
  weigh_report(reported, config_, start, out.report);
  PosedView placed = view;
  placed.place(start);
  out.report.live = live_.run(placed, others);
  const LiveSplicer::Report& live = out.report.live;
  const double pull_mm =
      (live.T_base_camera * shell_camera - out.T_base_camera * shell_camera).norm();
  out.possible = live.state != LiveSplicer::State::kContradicts &&
                 live.share_before < config_.sure_share_before;
  out.holds = live.state == LiveSplicer::State::kSpliced && !contradicted(live) &&
              place.chi_squared < PipePlaces::kFits && pull_mm < config_.max_pull_mm;
  return out;
}

PipePlacer::Report PipePlacer::by_partner(const PosedView& view, const PipePair& pair,
                                          const ReportedPose& reported,
                                          std::span<const PosedView> others, std::size_t partner,
                                          const PipePair& partners) const noexcept {
  const PipePlaces places = match_pipes(partners, pair, config_.depth_sigma_mm);
  std::array<bool, 2> open = {places.possible(0), places.possible(1)};
  const PosedView& a = others[partner];
  const std::array<bool, 2> near = {is_near(a.T_base_camera * places.places[0].T_a_b, reported),
                                    is_near(a.T_base_camera * places.places[1].T_a_b, reported)};
  Report out;
  out.state = open[0] || open[1] ? State::kContradicts : State::kOtherPipes;
  std::uint32_t num_possible = 0;
  for (std::size_t i = 0; i < open.size(); ++i) {
    const bool other_is_meant = near[1 - i] && open[1 - i] && !near[i];
    if (!open[i] || other_is_meant) {
      continue;
    }
    const Candidate c =
        candidate(view, a, places.places[i], reported, others, pair.nozzle.fit.cylinder.point_mm);
    num_possible += c.possible ? 1U : 0U;
    if (c.holds) {
      out = c.report;
      out.state = State::kPlaced;
    }
  }
  out.state = num_possible > 1 ? State::kAmbiguous : out.state;
  out.partner = static_cast<std::uint32_t>(partner);
  return out;
}

PipePlacer::Report PipePlacer::run(const PosedView& view, const PipePair& pair,
                                   const ReportedPose& reported, std::span<const PosedView> others,
                                   std::span<const PipePair> pairs) const noexcept {
  Report out;
  out.state = State::kNoPair;
  if (pair.state != PipePairState::kFound) {
    return out;
  }
  out.state = State::kNoPartner;
  for (std::size_t v = 0; v < others.size() && out.state != State::kPlaced; ++v) {
    if (!others[v].used || pairs[v].state != PipePairState::kFound) {
      continue;
    }
    const Report next = by_partner(view, pair, reported, others, v, pairs[v]);
    out = out.state == State::kAmbiguous && next.state != State::kPlaced ? out : next;
  }
  return out;
}

}  // namespace dseam::splice
