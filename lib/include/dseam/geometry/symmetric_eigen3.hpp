// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/base/lanes.hpp"

namespace dseam::geometry {

/// Three coordinates of eight vectors.
struct Vec3Lanes {
  lanes::FloatLanes x;
  lanes::FloatLanes y;
  lanes::FloatLanes z;
};

/// Eight symmetric 3x3 matrices.
struct Symmetric3Lanes {
  lanes::FloatLanes xx;
  lanes::FloatLanes xy;
  lanes::FloatLanes xz;
  lanes::FloatLanes yy;
  lanes::FloatLanes yz;
  lanes::FloatLanes zz;
};

/// Eigenvalues in rising order, and the unit vector of the least.
struct LeastAxisLanes {
  lanes::FloatLanes least;
  lanes::FloatLanes middle;
  lanes::FloatLanes most;
  Vec3Lanes axis;
};

/// Decomposes eight positive semi-definite matrices at once, in closed form but for three Newton
/// steps on a cubic whose root is known to lie in [sqrt 3, 2]: no iteration to convergence, no
/// sine.
///
/// First the eigenvalue that stands apart from the other two (the greatest or the least, after the
/// sign of the determinant), whose vector is well defined; then the 2x2 problem in the plane
/// across.
///
/// Errors:  a lane whose matrix is zero or not finite has an axis that means nothing; see the
///          eigenvalues.
/// Source:  D. Eberly, "A Robust Eigensolver for 3x3 Symmetric Matrices" (2014), for the order of
///          the two problems.
[[nodiscard]] LeastAxisLanes least_axis(const Symmetric3Lanes& matrix) noexcept;

}  // namespace dseam::geometry
