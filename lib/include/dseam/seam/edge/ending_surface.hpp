// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "dseam/seam/joint/joint_fit.hpp"

namespace dseam::seam {

/// One of a joint's two surfaces as it is where it ends near the other one: how far a point lies
/// off it, and how far along it from the other surface.
///
/// Frame:   that of the fit, which must outlive it.
class EndingSurface {
 public:
  enum class Which : std::uint8_t { kShell, kNozzle };

  EndingSurface() = default;
  EndingSurface(const JointFit& fit, Which which) noexcept
      : fit_(&fit), is_shell_(which == Which::kShell) {}

  [[nodiscard]] const JointFit& fit() const noexcept { return *fit_; }
  /// Distance from the surface, positive in the air; rough: without its deviation.
  [[nodiscard]] double rough_off(const Eigen::Vector3d& p) const noexcept {
    return is_shell_ ? shell_distance(joint(), p) : signed_distance(joint().nozzle, p);
  }
  [[nodiscard]] double off(const Eigen::Vector3d& p) const noexcept {
    return is_shell_ ? fit_->above_shell(p) : fit_->outside_nozzle(p);
  }
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& p) const noexcept {
    return is_shell_ ? shell_normal(joint(), p) : outward_normal(joint().nozzle, p);
  }
  /// Distance from the other surface.
  [[nodiscard]] double rough_away(const Eigen::Vector3d& p) const noexcept {
    return is_shell_ ? signed_distance(joint().nozzle, p) : shell_distance(joint(), p);
  }
  [[nodiscard]] double away(const Eigen::Vector3d& p) const noexcept {
    return is_shell_ ? fit_->outside_nozzle(p) : fit_->above_shell(p);
  }
  /// The direction in which away() grows.
  [[nodiscard]] Eigen::Vector3d outwards(const Eigen::Vector3d& p) const noexcept {
    return is_shell_ ? outward_normal(joint().nozzle, p) : shell_normal(joint(), p);
  }
  /// Not where the nozzle's axis leaves the shell on its other side.
  [[nodiscard]] bool is_beside(const Eigen::Vector3d& p) const noexcept {
    return shell_normal(joint(), p).dot(joint().nozzle.axis) >= 0.0;
  }
  [[nodiscard]] double angle_of(const Eigen::Vector3d& p) const noexcept {
    return angle_about(joint().nozzle, fit_->frame(), p);
  }
  [[nodiscard]] std::optional<Eigen::Vector3d> root_at(double phi_rad) const noexcept {
    return seam::root_at(joint(), fit_->frame(), phi_rad);
  }
  [[nodiscard]] const JointFit::Side& side() const noexcept {
    return is_shell_ ? fit_->shell() : fit_->nozzle();
  }
  [[nodiscard]] const JointFit::Side& other_side() const noexcept {
    return is_shell_ ? fit_->nozzle() : fit_->shell();
  }

 private:
  [[nodiscard]] const Joint& joint() const noexcept { return fit_->joint(); }

  const JointFit* fit_ = nullptr;
  bool is_shell_ = true;
};

}  // namespace dseam::seam
