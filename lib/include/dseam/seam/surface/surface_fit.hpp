// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "dseam/seam/surface/cell_map.hpp"
#include "dseam/seam/surface/surface.hpp"

namespace dseam::seam {

/// Gauss-Newton on the distances of points to one surface, whatever container the points are in.
class SurfaceEquations {
 public:
  void add(const Surface& surface, const Eigen::Vector3d& p, double weight = 1.0) noexcept;
  /// The surface after one step; nothing where the points leave a parameter free or it runs away.
  [[nodiscard]] std::optional<Surface> solve(const Surface& surface) const noexcept;
  [[nodiscard]] double weight() const noexcept { return weight_; }
  [[nodiscard]] double weighted_squares() const noexcept { return squares_; }

 private:
  SurfaceMatrix a_ = SurfaceMatrix::Zero();
  SurfaceVector b_ = SurfaceVector::Zero();
  double weight_ = 0.0;
  double squares_ = 0.0;
};

/// A first surface of the kind from positions and normals of a small patch.
///
/// Shape:   normals of the patch all to one side.
/// Errors:  nothing, where the patch does not curve enough to tell.
[[nodiscard]] std::optional<Surface> surface_of_patch(SurfaceKind kind,
                                                      std::span<const Cell> patch) noexcept;

}  // namespace dseam::seam
