// SPDX-License-Identifier: Apache-2.0
#include "markers/surface/disc_surface.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "markers/surface/ring_surface.hpp"

namespace dseam::markers {
namespace {

// Circle x^2 + y^2 = 2 a x + 2 b y + c through the rim, in the plane across the normal.
void fit_circle(const depth::Intrinsics& k, std::span<const Eigen::Vector2d> rim_px,
                const TangentQuadric& surface, SurfaceDisc& disc) noexcept {
  std::array<Eigen::Vector2d, EllipseEdge::kProfiles> points;
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < rim_px.size(); ++i) {
    const Eigen::Vector3d p = surface.meet(k, rim_px[i].x(), rim_px[i].y()) - surface.origin;
    points[i] = {p.dot(surface.e1), p.dot(surface.e2)};
    const Eigen::Vector3d r(2.0 * points[i].x(), 2.0 * points[i].y(), 1.0);
    h += r * r.transpose();
    g += r * points[i].squaredNorm();
  }
  const Eigen::Vector3d abc = h.ldlt().solve(g);
  const Eigen::Vector2d centre = abc.head<2>();
  disc.radius_mm = std::sqrt(std::max(0.0, abc(2) + centre.squaredNorm()));
  std::array<double, EllipseEdge::kProfiles> off{};
  for (std::size_t i = 0; i < rim_px.size(); ++i) {
    off[i] = (points[i] - centre).norm() - disc.radius_mm;
  }
  const RimScatter scatter = scatter_of(std::span(off).first(rim_px.size()));
  disc.out_of_round = scatter.rms / std::max(disc.radius_mm, 1e-9);
  disc.sigma_mm = scatter.sigma_of_mean();
  disc.centre = surface.origin + surface.e1 * centre.x() + surface.e2 * centre.y() +
                surface.normal * surface.height(centre.x(), centre.y());
}

}  // namespace

SurfaceDisc lay_on_surface(const depth::DepthImage& frame, const EllipseEdge& edge,
                           double max_hole_depth_mm, RingPixels& ring) noexcept {
  SurfaceDisc disc;
  const auto surface = fit_ring(frame, edge.ellipse, ring);
  if (!surface) {
    return disc;
  }
  if (is_hole(frame, edge.ellipse, surface->depth, max_hole_depth_mm)) {
    disc.state = DiscState::kHole;
    return disc;
  }
  disc.normal = surface->tangent.normal;
  fit_circle(frame.intrinsics, edge.rim(), surface->tangent, disc);
  constexpr double kMaxOutOfRound = 0.06;
  const bool round = disc.out_of_round < kMaxOutOfRound && disc.centre.allFinite();
  disc.state = round ? DiscState::kDisc : DiscState::kNotCircular;
  return disc;
}

}  // namespace dseam::markers
