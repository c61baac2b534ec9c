// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "dseam/geometry/symmetric_matrix.hpp"
#include "splice/network/network_adjustment.hpp"

namespace dseam::splice {
namespace {

using geometry::Matrix6;
using geometry::Vector6;

// Which part of a motion the ties count in: `told` is their information without noise, `ties` that
// with it, `all` that with the report's. A motion of unit length in `all` is known by its ties to
// the variance ties / told^2, by the report to 1 / (all - ties). What the report knows better is
// taken out square to it in lengths at `reach_mm`, not in `all`: the noise there would couple it
// with motions of all views together, which the ties must never feel.
Matrix6 tied_part(const Matrix6& told, const Matrix6& ties, const Matrix6& all,
                  double reach_mm) noexcept {
  const double square = reach_mm * reach_mm;
  Vector6 scale;
  scale << 1.0, 1.0, 1.0, square, square, square;
  const auto spread = geometry::eigen_of_symmetric<6>(all);
  const Matrix6 unit = spread.vectors * spread.values.cwiseSqrt().cwiseInverse().asDiagonal();
  const auto share = geometry::eigen_of_symmetric<6>(unit.transpose() * told * unit);
  Matrix6 part = Matrix6::Identity();
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Vector6 motion = unit * share.vectors.col(i);
    const double known = std::max(0.0, share.values(i));
    const double noisy = motion.dot(ties * motion);
    if (known * known < noisy * (1.0 - noisy)) {
      const Vector6 along = part * motion;
      const Vector6 across = scale.asDiagonal() * along;
      part -= along * across.transpose() / along.dot(across);
    }
  }
  return part;
}

}  // namespace

// What the ties of a view tell less of than its report does is left to the report: noise would
// drag it.
void Adjustment::hold_free_motions() noexcept {
  holds = false;
  assemble_ties(true);
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    tied[v] = system.block(6 * v, 6 * v);
  }
  assemble_ties(false);
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    const Matrix6 ties = system.block(6 * v, 6 * v);
    const Matrix6 told = tied[v];
    tied[v].setIdentity();
    if (views[v].used && inputs[v].reported.known) {
      add_reported_tie(views[v].T_base_camera, inputs[v].reported.T_base_camera, pivot, config,
                       6 * v, system);
      tied[v] = tied_part(told, ties, system.block(6 * v, 6 * v), reach_mm);
      holds = holds || !tied[v].isIdentity(0.0);
    }
  }
}

}  // namespace dseam::splice
