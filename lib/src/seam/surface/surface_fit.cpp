// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/surface/surface_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace dseam::seam {
namespace {

constexpr double kMaxRadiusMm = 5000.0;

struct PatchSums {
  Eigen::Vector3d mean_point = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_normal = Eigen::Vector3d::Zero();
  Eigen::Matrix3d points = Eigen::Matrix3d::Zero();   // About their mean.
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();  // Not centred.
};

PatchSums sums_of(std::span<const Cell> patch) noexcept {
  PatchSums s;
  const double n = static_cast<double>(patch.size());
  for (const Cell& c : patch) {
    s.mean_point += c.mean / n;
    s.mean_normal += c.normal / n;
  }
  for (const Cell& c : patch) {
    s.points += (c.mean - s.mean_point) * (c.mean - s.mean_point).transpose() / n;
    s.normals += c.normal * c.normal.transpose() / n;
  }
  return s;
}

Eigen::Vector3d smallest_direction(const Eigen::Matrix3d& m) noexcept {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(m);
  return solver.eigenvectors().col(0);
}

// Centre and radius with p = centre + radius * normal, in the space that `project` keeps.
std::optional<Surface> round_surface(SurfaceKind kind, std::span<const Cell> patch,
                                     const PatchSums& s, const Eigen::Vector3d& axis) noexcept {
  const Eigen::Matrix3d project =
      kind == SurfaceKind::kSphere
          ? Eigen::Matrix3d::Identity()
          : Eigen::Matrix3d(Eigen::Matrix3d::Identity() - axis * axis.transpose());
  double mixed = 0.0;
  double turn = 0.0;
  for (const Cell& c : patch) {
    const Eigen::Vector3d dn = project * (c.normal - s.mean_normal);
    mixed += dn.dot(c.mean - s.mean_point);
    turn += dn.squaredNorm();
  }
  const double radius = mixed / turn;
  if (!(std::abs(radius) < kMaxRadiusMm)) {
    return std::nullopt;
  }
  const Eigen::Vector3d centre = s.mean_point - radius * (project * s.mean_normal);
  return Surface{kind, centre, axis, std::abs(radius), 0.0};
}

}  // namespace

std::optional<Surface> SurfaceEquations::solve() const noexcept {
  const Surface& surface = probe_.surface();
  SurfaceMatrix a = a_;
  const int n = num_parameters(surface.kind);
  for (int i = 0; i < kMaxSurfaceParameters; ++i) {
    a(i, i) = i < n ? a(i, i) * (1.0 + 1e-9) + 1e-12 : 1.0;
  }
  const SurfaceVector step = -a.ldlt().solve(b_);
  if (!step.allFinite() || weight_ <= n) {
    return std::nullopt;
  }
  const Surface next = stepped(surface, step);
  const bool round = surface.kind != SurfaceKind::kPlane;
  if (!next.point.allFinite() ||
      (round && !(next.radius_mm > 0.0 && next.radius_mm < kMaxRadiusMm)) ||
      !(std::abs(next.slope) < 3.0)) {
    return std::nullopt;
  }
  return next;
}

std::optional<Surface> surface_of_patch(SurfaceKind kind, std::span<const Cell> patch) noexcept {
  if (patch.size() < 6) {
    return std::nullopt;
  }
  const PatchSums s = sums_of(patch);
  switch (kind) {
    case SurfaceKind::kPlane:
      return Surface{kind, s.mean_point, smallest_direction(s.points), 0.0, 0.0};
    case SurfaceKind::kSphere:
      return round_surface(kind, patch, s, Eigen::Vector3d::UnitZ());
    case SurfaceKind::kCylinder:
      return round_surface(kind, patch, s, smallest_direction(s.normals));
    case SurfaceKind::kCone:  // Starts as the cylinder that touches the patch.
      return round_surface(kind, patch, s, smallest_direction(s.normals));
  }
  return std::nullopt;
}

}  // namespace dseam::seam
