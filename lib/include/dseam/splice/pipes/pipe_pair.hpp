// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/geometry/cylinder_fit.hpp"

namespace dseam::splice {

/// What an error of all depths together does to a pipe's five parameters, for each mm of: a depth
/// bowl along the image's x, one along y (at the image's sides), and an offset.
using DepthEffect = Eigen::Matrix<double, 5, 3>;

/// One pipe's outside, or its inside, as one view sees it.
///
/// Frame:   camera.
/// Shape:   the fit's covariance allows for residuals that hang together and for a section that may
///          be oval; it does not hold the effect of the depths.
struct Pipe {
  bool usable = false;  ///< Known well enough to be one of a pair.
  geometry::CylinderFit fit;
  DepthEffect depth_effect = DepthEffect::Zero();
  double ovality_mm = 0.0;        ///< Of the half-axes about the radius; 0: not told from round.
  double oval_chi_squared = 0.0;  ///< Of the ovality, two degrees of freedom.
  double patches_per_independent = 1.0;
};

enum class PipePairState : std::uint8_t {
  kFound,
  kNoPipe,
  kOnePipe,
  kMorePipes,  ///< Another one might be meant as well.
  kAlike,      ///< Radii so near to each other that nobody can say which is the shell.
  kParallel,   ///< The axes leave a slide along them free.
  kTooNarrow,  ///< Seen too little way round or along: an axis or a radius is not determined.
  kNotRound,   ///< Further from a cylinder, or more oval, than a pipe is.
};

/// Shell and nozzle in one view: two axes that are not parallel, which leave no motion free.
///
/// Frame:   camera.
/// Shape:   axes of nozzle and bore point away from the shell; the sense of the shell's means
///          nothing. Found is a pair of which the nozzle's outside or its bore can be used.
struct PipePair {
  PipePairState state = PipePairState::kNoPipe;
  Pipe shell;
  Pipe nozzle;
  Pipe bore;  ///< The nozzle's inside: all that a view along the nozzle sees of it.
};

}  // namespace dseam::splice
