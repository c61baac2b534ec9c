// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/depth/depth_image.hpp"
#include "dseam/splice/pipes/pipe_pair.hpp"

namespace dseam::splice {

/// Fits a pipe whose section may be a little oval, starting from its fit as round.
///
/// On a part of the way round a section that is a little oval looks like a round one of another
/// radius: without the ovality as an unknown the axis would be told far too surely.
///
/// Shape:   `points` in the order of the image's rows: how residuals of neighbours hang together
///          tells how many errors are independent; at least as few as `pipe` says beforehand.
/// Time:    O(points), a bounded number of iterations.
/// Errors:  the fit's state is kDegenerate where the points do not determine it.
void settle_form(const geometry::PointSpans& points, const depth::Intrinsics& k,
                 double ovality_sigma_mm, Pipe& pipe) noexcept;

}  // namespace dseam::splice
