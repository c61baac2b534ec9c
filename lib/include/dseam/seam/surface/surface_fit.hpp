// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "dseam/seam/surface/cell_map.hpp"
#include "dseam/seam/surface/surface_probe.hpp"

namespace dseam::seam {

/// Gauss-Newton on the distances of points to one surface, whatever container the points are in.
class SurfaceEquations {
 public:
  explicit SurfaceEquations(const Surface& surface) noexcept
      : probe_(surface), frame_(across(surface.axis)) {}

  /// For who asks the surface about a point before adding it.
  [[nodiscard]] const SurfaceProbe& probe() const noexcept { return probe_; }
  [[gnu::always_inline]] void add(const SurfaceProbe::Contact& contact, double weight) noexcept {
    const SurfaceVector j = probe_.jacobian(contact, frame_);
    a_.noalias() += (weight * j) * j.transpose();
    b_ += weight * contact.distance_mm * j;
    weight_ += weight;
    squares_ += weight * contact.distance_mm * contact.distance_mm;
  }
  void add(const Eigen::Vector3d& p, double weight = 1.0) noexcept { add(probe_.touch(p), weight); }
  /// The surface after one step; nothing where the points leave a parameter free or it runs away.
  [[nodiscard]] std::optional<Surface> solve() const noexcept;
  [[nodiscard]] double weight() const noexcept { return weight_; }
  [[nodiscard]] double weighted_squares() const noexcept { return squares_; }

 private:
  SurfaceProbe probe_;
  AcrossAxis frame_;
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
