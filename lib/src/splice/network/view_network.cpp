// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/view_network.hpp"

#include <algorithm>
#include <cmath>

#include "dseam/geometry/symmetric_matrix.hpp"
#include "splice/network/network_adjustment.hpp"

namespace dseam::splice {
namespace {

using geometry::Matrix6;
using geometry::Vector6;

Matrix6 block_of(const BlockSystem& system, std::size_t row, std::size_t column) noexcept {
  Matrix6 out;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) {
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          system.inverse(row + i, column + j);
    }
  }
  return out;
}

}  // namespace

// An error that all depths have in common moves every view along its own axis, and nothing in the
// views can tell: poses take it up. What all views share of it belongs to the base.
Vector6 Adjustment::offset_effect(std::size_t v) const noexcept {
  Vector6 effect = Vector6::Zero();
  effect.head<3>() = config.offset_sigma_mm * views[v].T_base_camera.rotation.col(2);
  return effect;
}

void Adjustment::fill_covariances() noexcept {
  system.invert();
  const double n = static_cast<double>(num_used());
  Matrix6 to_origin = Matrix6::Identity();
  to_origin.topRightCorner<3, 3>() = geometry::skew(pivot);
  Matrix6 mean = Matrix6::Zero();
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    for (std::size_t w = 0; views[v].used && w < inputs.size(); ++w) {
      mean += views[w].used ? Matrix6(block_of(system, 6 * v, 6 * w) / (n * n)) : Matrix6::Zero();
    }
  }
  Vector6 mean_offset = Vector6::Zero();
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    mean_offset += views[v].used ? Vector6(offset_effect(v) / n) : Vector6::Zero();
  }
  report.base_covariance =
      to_origin * (mean + mean_offset * mean_offset.transpose()) * to_origin.transpose();
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    if (!views[v].used) {
      continue;
    }
    Matrix6 with_mean = Matrix6::Zero();
    for (std::size_t w = 0; w < inputs.size(); ++w) {
      with_mean += views[w].used ? Matrix6(block_of(system, 6 * v, 6 * w) / n) : Matrix6::Zero();
    }
    const Vector6 offset = offset_effect(v) - mean_offset;
    const Matrix6 relative = block_of(system, 6 * v, 6 * v) - with_mean - with_mean.transpose() +
                             mean + offset * offset.transpose();
    constexpr double kReachMm = 100.0;
    Vector6 scale;
    scale << 1.0, 1.0, 1.0, kReachMm, kReachMm, kReachMm;
    const auto spread =
        geometry::eigen_of_symmetric<6>(scale.asDiagonal() * relative * scale.asDiagonal());
    const double largest = std::sqrt(std::max(0.0, spread.values(5)));
    out[v].state = largest > config.max_sigma_mm ? ViewState::kUnobservable : ViewState::kUsed;
    out[v].covariance = to_origin * relative * to_origin.transpose();
  }
}

void Adjustment::fill_views() noexcept {
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    SplicedView& view = out[v];
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
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return network;
}

NetworkReport ViewNetwork::run(std::span<const NetworkView> views,
                               std::span<const MarkerSight> sights,
                               Buffer<SplicedView>& out) noexcept {
  const std::size_t count = std::min({views.size(), cloud::kMaxViews, out.capacity()});
  Adjustment adjustment{config_, system_, views.first(count), sights, posed_.first(count), out};
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
  adjustment.leave_out_unlinked();
  if (adjustment.num_used() == 0) {
    adjustment.report.state = NetworkState::kNoViews;
    adjustment.fill_views();
    return adjustment.report;
  }
  adjustment.adjust();
  if (adjustment.report.state != NetworkState::kSingular) {
    adjustment.fill_covariances();
  }
  adjustment.fill_views();
  if (adjustment.num_used() == 1) {
    adjustment.report.state = NetworkState::kOneView;
  }
  return adjustment.report;
}

}  // namespace dseam::splice
