// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "dseam/geometry/rigid_transform.hpp"
#include "dseam/splice/pipes/pipe_pair.hpp"

namespace dseam::splice {

/// Where view b lies to view a if both see the same two pipes.
///
/// Shape:   `covariance` is that of a left perturbation (`geometry::perturbed`) about a's origin.
struct PipePlace {
  geometry::RigidTransform T_a_b;
  geometry::Matrix6 covariance = geometry::Matrix6::Zero();
  /// Of what a pose cannot change: the two radii, the angle and the distance of the axes.
  double chi_squared = std::numeric_limits<double>::infinity();
};

/// Both senses in which the shell's axis may run. A part that is symmetric about its nozzle's axis
/// has two places that fit.
struct PipePlaces {
  static constexpr double kFits = 30.0;       ///< chi-squared at most, four degrees of freedom,
  static constexpr double kRuledOut = 100.0;  ///< and beyond this it is another place or part.
  std::array<PipePlace, 2> places{};

  [[nodiscard]] bool possible(std::size_t i) const noexcept {
    return places[i].chi_squared < kRuledOut;
  }
};

/// Weighted least squares over both pairs' ten parameters, from a closed form: shell and nozzle, or
/// shell and bore where one of the views does not see the nozzle's outside.
///
/// Units:   `depth_sigma_mm` is the standard deviation of a depth bowl and offset that all views of
///          one scanner have in common.
/// Shape:   both pairs were found.
[[nodiscard]] PipePlaces match_pipes(const PipePair& a, const PipePair& b,
                                     double depth_sigma_mm) noexcept;

}  // namespace dseam::splice
