// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "dseam/geometry/symmetric_matrix.hpp"
#include "splice/network/network_adjustment.hpp"

namespace dseam::splice {

using geometry::Matrix6;
using geometry::Vector6;

// An error that all depths have in common moves every view along its own axis, and nothing in the
// views can tell: poses take it up. What all views share of it belongs to the base.
Vector6 Adjustment::offset_effect(std::size_t v) const noexcept {
  Vector6 effect = Vector6::Zero();
  effect.head<3>() = config.offset_sigma_mm * views[v].T_base_camera.rotation.col(2);
  return effect;
}

// The information says how far the poses give way to an error of the surfaces, and for that noise
// in the normals must not count; how large that error is, noise included, is what the steps go by,
// but for how it spreads by facing. False where without the noise a direction is free.
bool Adjustment::invert_information() noexcept {
  const std::array<double, kFacings> spread = surface.spread();
  assemble(true);
  const bool known = system.factorise();
  if (known) {
    system.invert();
    assemble(false, spread);
    system.sandwich();
    return true;
  }
  assemble(false);
  if (system.factorise()) {
    system.invert();
  }
  return false;
}

// Of what all views have in common; each view's covariance with it is left on the joint diagonal.
void Adjustment::fill_mean() noexcept {
  const double n = static_cast<double>(num_used());
  Matrix6 mean = Matrix6::Zero();
  mean_offset.setZero();
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    auto with_mean = joint.at(v, v);
    with_mean.setZero();
    for (std::size_t w = 0; views[v].used && w < inputs.size(); ++w) {
      with_mean +=
          views[w].used ? Matrix6(system.inverse_block(6 * v, 6 * w) / n) : Matrix6::Zero();
    }
    mean += with_mean / n;
    mean_offset += views[v].used ? Vector6(offset_effect(v) / n) : Vector6::Zero();
  }
  report.base_covariance = mean;
}

// Of each view's difference to the mean of all.
void Adjustment::fill_joint() noexcept {
  fill_mean();
  const auto fill = [&](std::size_t v, std::size_t w) noexcept {
    const Vector6 ov = offset_effect(v) - mean_offset;
    const Vector6 ow = offset_effect(w) - mean_offset;
    joint.at(v, w) =
        views[v].used && views[w].used
            ? Matrix6(system.inverse_block(6 * v, 6 * w) - joint.at(v, v) -
                      joint.at(w, w).transpose() + report.base_covariance + ov * ow.transpose())
            : Matrix6::Zero();
  };
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    for (std::size_t w = 0; w < inputs.size(); ++w) {
      if (w != v) {
        fill(v, w);
      }
    }
  }
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    fill(v, v);
  }
  report.base_covariance += mean_offset * mean_offset.transpose();
}

// The worst that a view's covariance lets it be off by at what is seen.
double Adjustment::sigma_of(std::size_t v) const noexcept {
  Vector6 scale;
  scale << 1.0, 1.0, 1.0, reach_mm, reach_mm, reach_mm;
  const auto spread =
      geometry::eigen_of_symmetric<6>(scale.asDiagonal() * joint.at(v, v) * scale.asDiagonal());
  return std::sqrt(std::max(0.0, spread.values(5)));
}

}  // namespace dseam::splice
