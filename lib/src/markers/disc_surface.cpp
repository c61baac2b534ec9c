// SPDX-License-Identifier: Apache-2.0
#include "markers/disc_surface.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "dseam/geometry/cylinder_fit.hpp"

namespace dseam::markers {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kInnerRing = 1.25;
constexpr double kOuterRing = 2.5;
constexpr double kMaxGateMm = 2.0;

// z = q . (1, x, y, x^2, x y, y^2), x and y being pixels from the centre over `scale`.
struct DepthQuadric {
  Vector6 q = Vector6::Zero();
  double u = 0.0;
  double v = 0.0;
  double scale = 1.0;

  [[nodiscard]] Vector6 row(double pu, double pv) const noexcept {
    const double x = (pu - u) / scale;
    const double y = (pv - v) / scale;
    Vector6 r;
    r << 1.0, x, y, x * x, x * y, y * y;
    return r;
  }
  [[nodiscard]] double z(double pu, double pv) const noexcept { return q.dot(row(pu, pv)); }
};

Eigen::Vector3d ray(const depth::Intrinsics& k, double u, double v) noexcept {
  return {(u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0};
}

struct Window {
  std::uint32_t u0, u1, v0, v1, step;
};

Window window_around(const depth::DepthImage& frame, const geometry::Ellipse& rim,
                     double reach) noexcept {
  const auto limit = [](double x, std::uint32_t size) {
    return static_cast<std::uint32_t>(std::clamp(x, 0.0, static_cast<double>(size)));
  };
  const double r = reach * rim.a;
  const auto step = static_cast<std::uint32_t>(std::clamp(r / 20.0, 1.0, 1e4));
  return {limit(rim.u - r, frame.intrinsics.width), limit(rim.u + r + 1.0, frame.intrinsics.width),
          limit(rim.v - r, frame.intrinsics.height),
          limit(rim.v + r + 1.0, frame.intrinsics.height), step};
}

struct RingSums {
  Matrix6 h = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  double squares = 0.0;
  double used = 0.0;
  double valid = 0.0;
};

RingSums sum_ring(const depth::DepthImage& frame, const geometry::Ellipse& rim,
                  const DepthQuadric& surface, double gate_mm) noexcept {
  RingSums sums;
  const Window w = window_around(frame, rim, kOuterRing);
  for (std::uint32_t v = w.v0; v < w.v1; v += w.step) {
    for (std::uint32_t u = w.u0; u < w.u1; u += w.step) {
      const std::uint16_t count = frame.count_at(u, v);
      const double relative = rim.relative_radius(u, v);
      if (count == 0 || relative < kInnerRing || relative > kOuterRing) {
        continue;
      }
      sums.valid += 1.0;
      const double z = count * frame.mm_per_count;
      const double residual = z - surface.z(u, v);
      if (std::abs(residual) > gate_mm) {
        continue;
      }
      const Vector6 r = surface.row(u, v);
      sums.h.noalias() += r * r.transpose();
      sums.g += residual * r;
      sums.squares += residual * residual;
      sums.used += 1.0;
    }
  }
  return sums;
}

// A start that one wild pixel cannot spoil: the median depth of the ring's four sides.
double start_depth(const depth::DepthImage& frame, const geometry::Ellipse& rim) noexcept {
  std::array<double, 64> z{};
  std::size_t n = 0;
  for (std::size_t k = 0; k < z.size(); ++k) {
    const double t =
        2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(z.size());
    const double r = rim.a * (k % 2 == 0 ? 1.4 : 1.9);
    const double u = rim.u + r * std::cos(t);
    const double v = rim.v + r * std::sin(t);
    if (u >= 0.0 && v >= 0.0 && u < frame.intrinsics.width && v < frame.intrinsics.height) {
      const std::uint16_t count =
          frame.count_at(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v));
      z[n] = count * frame.mm_per_count;
      n += count > 0 ? 1 : 0;
    }
  }
  if (n < 8) {
    return 0.0;
  }
  const auto middle = z.begin() + static_cast<std::ptrdiff_t>(n / 2);
  std::nth_element(z.begin(), middle, z.begin() + static_cast<std::ptrdiff_t>(n));
  return *middle;
}

bool fit_surface(const depth::DepthImage& frame, const geometry::Ellipse& rim,
                 DepthQuadric& surface) noexcept {
  surface.u = rim.u;
  surface.v = rim.v;
  surface.scale = rim.a;
  surface.q(0) = start_depth(frame, rim);
  if (!(surface.q(0) > 0.0)) {
    return false;
  }
  // The first gate lets a steep surface in; the last keeps flying pixels out.
  double gate = std::max(kMaxGateMm, 4.0 * kOuterRing * rim.a * surface.q(0) / frame.intrinsics.fx);
  for (int round = 0; round < 6; ++round) {
    const RingSums sums = sum_ring(frame, rim, surface, gate);
    if (sums.used < 24.0 || sums.used < 0.5 * sums.valid) {
      return false;
    }
    surface.q += sums.h.ldlt().solve(sums.g);
    const double rms = std::sqrt(sums.squares / sums.used);
    gate = std::max(0.06, std::min(gate, round == 0 ? rms : 3.0 * rms));
  }
  return surface.q.allFinite() && surface.q(0) > 0.0;
}

Eigen::Vector3d point_on(const depth::DepthImage& frame, const DepthQuadric& s, double u,
                         double v) noexcept {
  return ray(frame.intrinsics, u, v) * s.z(u, v);
}

Eigen::Vector3d normal_at_centre(const depth::DepthImage& frame, const DepthQuadric& s) noexcept {
  const double h = 0.25 * s.scale;
  const Eigen::Vector3d du = point_on(frame, s, s.u + h, s.v) - point_on(frame, s, s.u - h, s.v);
  const Eigen::Vector3d dv = point_on(frame, s, s.u, s.v + h) - point_on(frame, s, s.u, s.v - h);
  const Eigen::Vector3d n = du.cross(dv).normalized();
  return n.z() > 0.0 ? Eigen::Vector3d(-n) : n;
}

// Circle x^2 + y^2 = 2 a x + 2 b y + c through the rim, in the plane across the normal.
void fit_circle(const depth::DepthImage& frame, const geometry::Ellipse& rim,
                const DepthQuadric& surface, SurfaceDisc& disc) noexcept {
  constexpr int kPoints = 32;
  const Eigen::Vector3d origin = point_on(frame, surface, rim.u, rim.v);
  Eigen::Vector3d e1;
  Eigen::Vector3d e2;
  geometry::orthonormal_base(disc.normal, e1, e2);
  std::array<Eigen::Vector2d, kPoints> points;
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  for (int k = 0; k < kPoints; ++k) {
    const double t = 2.0 * std::numbers::pi * k / kPoints;
    const double x = rim.a * std::cos(t);
    const double y = rim.b * std::sin(t);
    const double c = std::cos(rim.angle_rad);
    const double s = std::sin(rim.angle_rad);
    const Eigen::Vector3d p =
        point_on(frame, surface, rim.u + x * c - y * s, rim.v + x * s + y * c) - origin;
    points[static_cast<std::size_t>(k)] = {p.dot(e1), p.dot(e2)};
    const Eigen::Vector3d r(2.0 * p.dot(e1), 2.0 * p.dot(e2), 1.0);
    h += r * r.transpose();
    g += r * points[static_cast<std::size_t>(k)].squaredNorm();
  }
  const Eigen::Vector3d abc = h.ldlt().solve(g);
  const Eigen::Vector2d centre = abc.head<2>();
  disc.radius_mm = std::sqrt(std::max(0.0, abc(2) + centre.squaredNorm()));
  double squares = 0.0;
  for (const Eigen::Vector2d& p : points) {
    const double d = (p - centre).norm() - disc.radius_mm;
    squares += d * d / kPoints;
  }
  disc.out_of_round = std::sqrt(squares) / std::max(disc.radius_mm, 1e-9);
  disc.centre = origin + e1 * centre.x() + e2 * centre.y();
}

// Along its ray onto the surface: the centre lies in the tangent plane, a hair off a curved one.
Eigen::Vector3d drop_on_surface(const depth::DepthImage& frame, const DepthQuadric& s,
                                const Eigen::Vector3d& centre, const Eigen::Vector3d& n) noexcept {
  Eigen::Vector3d p = centre;
  for (int round = 0; round < 3; ++round) {
    const Eigen::Vector3d q =
        point_on(frame, s, frame.intrinsics.fx * p.x() / p.z() + frame.intrinsics.cx,
                 frame.intrinsics.fy * p.y() / p.z() + frame.intrinsics.cy);
    p += n * n.dot(q - p);
  }
  return p;
}

bool is_hole(const depth::DepthImage& frame, const geometry::Ellipse& rim, const DepthQuadric& s,
             double max_depth_mm) noexcept {
  const Window w = window_around(frame, rim, 0.8);
  double valid = 0.0;
  double off = 0.0;
  for (std::uint32_t v = w.v0; v < w.v1; v += w.step) {
    for (std::uint32_t u = w.u0; u < w.u1; u += w.step) {
      const std::uint16_t count = frame.count_at(u, v);
      if (count == 0 || rim.relative_radius(u, v) > 0.8) {
        continue;
      }
      valid += 1.0;
      off += std::abs(count * frame.mm_per_count - s.z(u, v)) > max_depth_mm ? 1.0 : 0.0;
    }
  }
  return off > 3.0 && off > 0.25 * valid;
}

}  // namespace

SurfaceDisc lay_on_surface(const depth::DepthImage& frame, const geometry::Ellipse& rim,
                           double max_hole_depth_mm) noexcept {
  SurfaceDisc disc;
  DepthQuadric surface;
  if (!fit_surface(frame, rim, surface)) {
    return disc;
  }
  if (is_hole(frame, rim, surface, max_hole_depth_mm)) {
    disc.state = DiscState::kHole;
    return disc;
  }
  disc.normal = normal_at_centre(frame, surface);
  fit_circle(frame, rim, surface, disc);
  disc.centre = drop_on_surface(frame, surface, disc.centre, disc.normal);
  constexpr double kMaxOutOfRound = 0.06;
  const bool round = disc.out_of_round < kMaxOutOfRound && disc.centre.allFinite();
  disc.state = round ? DiscState::kDisc : DiscState::kNotCircular;
  return disc;
}

}  // namespace dseam::markers
