// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/view_network.hpp"

#include <algorithm>
#include <cmath>

#include "splice/network/network_adjustment.hpp"

namespace dseam::splice {
namespace {

using geometry::Matrix6;

Matrix6 about_origin(const Matrix6& covariance, const Eigen::Vector3d& pivot) noexcept {
  Matrix6 to_origin = Matrix6::Identity();
  to_origin.topRightCorner<3, 3>() = geometry::skew(pivot);
  return to_origin * covariance * to_origin.transpose();
}

}  // namespace

// What is free to slide must not be fused; the view that is known worst goes first.
bool Adjustment::leave_out_unobservable() noexcept {
  const bool known = invert_information();
  fill_joint();
  double worst = 0.0;
  std::size_t which = 0;
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    const double sigma = views[v].used ? sigma_of(v) : -1.0;
    which = sigma >= worst ? v : which;
    worst = std::max(worst, sigma);
  }
  const bool free = num_used() > 1 && (!known || worst > config.max_sigma_mm);
  if (free) {
    leave_out(which, ViewState::kUnobservable);
  }
  return free;
}

void Adjustment::fill_views() noexcept {
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    SplicedView& view = out[v];
    for (std::size_t w = 0; w < inputs.size(); ++w) {
      joint.at(v, w) = about_origin(joint.at(v, w), pivot);
    }
    if (views[v].used) {
      const bool known = report.state != NetworkState::kSingular;
      view.state = known ? ViewState::kUsed : ViewState::kUnobservable;
    }
    view.covariance = joint.at(v, v);
    view.T_base_camera = views[v].T_base_camera;
    view.num_markers = markers.count[v];
    view.marker_rms_mm =
        std::sqrt(markers.squares[v] / std::max<std::uint32_t>(1, markers.count[v]));
    view.surface_rms_mm =
        std::sqrt(surface.squares[v] / std::max<std::uint32_t>(1, surface.near[v]));
    if (views[v].used && inputs[v].reported.known) {
      view.reported_pose_rejected =
          reported_residual(view.T_base_camera, inputs[v].reported.T_base_camera, config)
              .chi_squared > kReportedChiSquaredLimit;
    }
    report.num_used += views[v].used ? 1U : 0U;
  }
  report.base_covariance = about_origin(report.base_covariance, pivot);
  report.num_left_out = static_cast<std::uint32_t>(inputs.size()) - report.num_used;
  report.num_markers = markers.landmarks;
  report.num_markers_rejected = markers.rejected;
  report.surface_sigma_mm = sigma_mm;
  report.ties_per_independent = ties_per_independent;
}

Result<ViewNetwork> ViewNetwork::make(const Config& config, Arena& arena) noexcept {
  const bool sigmas_ok = config.reported_sigma_mm > 0.0 && config.reported_sigma_rad > 0.0 &&
                         config.bowl_sigma_mm > 0.0 && config.max_sigma_mm > 0.0;
  if (!sigmas_ok || !(config.final_gate_mm > 0.0) || config.start_gate_mm < config.final_gate_mm) {
    return Errc::kInvalidArgument;
  }
  ViewNetwork network(config);
  network.system_ = BlockSystem(kUnknowns, arena);
  network.posed_ = arena.take<PosedView>(cloud::kMaxViews);
  network.tied_ = arena.take<Matrix6>(cloud::kMaxViews);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  network.joint_.cells = network.system_.spare().first(JointCovariance::kCells);
  return network;
}

NetworkReport ViewNetwork::run(std::span<const NetworkView> views,
                               std::span<const MarkerSight> sights,
                               Buffer<SplicedView>& out) noexcept {
  const std::size_t count = std::min({views.size(), cloud::kMaxViews, out.capacity()});
  Adjustment adjustment{
      config_, system_, views.first(count), sights, posed_.first(count), tied_.first(count),
      joint_,  out};
  adjustment.take_in();
  if (adjustment.num_used() == 0) {
    return adjustment.report;
  }
  adjustment.choose_pivot();
  adjustment.vote_on_base();
  adjustment.choose_pivot();
  adjustment.adjust();
  for (std::size_t round = 0; round < count && adjustment.leave_out_worst(); ++round) {
    adjustment.adjust();
  }
  for (std::size_t round = 0; round < count && adjustment.num_used() > 0; ++round) {
    const bool unlinked = adjustment.leave_out_unlinked();
    adjustment.hold_free_motions();
    if (adjustment.holds || unlinked) {
      adjustment.adjust();
    }
    if (adjustment.report.state == NetworkState::kSingular ||
        !adjustment.leave_out_unobservable()) {
      break;
    }
    adjustment.adjust();
  }
  if (adjustment.report.state == NetworkState::kSingular || adjustment.num_used() == 0) {
    std::fill(joint_.cells.begin(), joint_.cells.end(), 0.0);
  }
  adjustment.fill_views();
  if (adjustment.num_used() == 0) {
    adjustment.report.state = NetworkState::kNoViews;
    return adjustment.report;
  }
  if (adjustment.num_used() == 1) {
    adjustment.report.state = NetworkState::kOneView;
  }
  return adjustment.report;
}

}  // namespace dseam::splice
