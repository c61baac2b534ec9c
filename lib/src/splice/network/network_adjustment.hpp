// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "dseam/splice/view_network.hpp"
#include "splice/network/network_ties.hpp"
#include "splice/network/surface_ties.hpp"

namespace dseam::splice {

/// The adjustment in progress; what run() keeps on the stack.
struct Adjustment {
  const ViewNetwork::Config& config;
  BlockSystem& system;
  std::span<const NetworkView> inputs;
  std::span<const MarkerSight> sights;
  std::span<PosedView> views;
  std::span<geometry::Matrix6> tied;  ///< Which part of each view's motion its ties tell.
  JointCovariance& joint;
  Buffer<SplicedView>& out;
  NetworkReport report{};

  SurfaceStatistics surface{};
  MarkerStatistics markers{};
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
  double sigma_mm = 0.0;
  bool holds = false;  ///< Some motions are left to the reports.
  double marker_variance_factor = 1.0;
  double ties_per_independent = 1.0;
  double decrement = 0.0;  ///< The last step's squared length in sigmas.
  double gate_mm = 0.0;    ///< Of the last step.
  double reach_mm = 0.0;   ///< How far what is seen lies about the pivot.
  geometry::Vector6 mean_offset = geometry::Vector6::Zero();

  [[nodiscard]] std::size_t bowl_at() const noexcept { return 6 * inputs.size(); }
  [[nodiscard]] std::size_t num_used() const noexcept {
    return static_cast<std::size_t>(
        std::count_if(views.begin(), views.end(), [](const PosedView& view) { return view.used; }));
  }

  void take_in() noexcept;
  void choose_pivot() noexcept;
  void vote_on_base() noexcept;
  void adjust() noexcept;
  void settle_marker_variance() noexcept;
  bool settle_weights() noexcept;
  void assemble(bool without_noise,
                const std::array<double, kFacings>& spread = kEvenSpread) noexcept;
  void assemble_ties(bool without_noise,
                     const std::array<double, kFacings>& spread = kEvenSpread) noexcept;
  double step() noexcept;
  void add_reports() noexcept;
  void leave_out(std::size_t v, ViewState why) noexcept;
  bool leave_out_worst() noexcept;
  bool leave_out_unlinked() noexcept;
  void hold_free_motions() noexcept;
  bool leave_out_unobservable() noexcept;
  [[nodiscard]] bool invert_information() noexcept;
  [[nodiscard]] geometry::Vector6 offset_effect(std::size_t v) const noexcept;
  [[nodiscard]] double sigma_of(std::size_t v) const noexcept;
  void fill_mean() noexcept;
  void fill_joint() noexcept;
  void fill_views() noexcept;
};

}  // namespace dseam::splice
