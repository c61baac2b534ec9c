// SPDX-License-Identifier: Apache-2.0
#include "markers/ring_surface.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "dseam/geometry/cylinder_fit.hpp"

namespace dseam::markers {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kInnerRing = 1.25;
constexpr double kOuterRing = 2.5;
constexpr double kMaxGateMm = 2.0;

Vector6 quadratic(double x, double y) noexcept {
  Vector6 r;
  r << 1.0, x, y, x * x, x * y, y * y;
  return r;
}

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
      const Vector6 r = quadratic((u - surface.u) / surface.scale, (v - surface.v) / surface.scale);
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
  surface.gate_mm = gate;
  return surface.q.allFinite() && surface.q(0) > 0.0;
}

Eigen::Vector3d normal_at_centre(const depth::Intrinsics& k, const DepthQuadric& s) noexcept {
  const auto point = [&](double u, double v) { return Eigen::Vector3d(ray(k, u, v) * s.z(u, v)); };
  const double h = 0.25 * s.scale;
  const Eigen::Vector3d du = point(s.u + h, s.v) - point(s.u - h, s.v);
  const Eigen::Vector3d dv = point(s.u, s.v + h) - point(s.u, s.v - h);
  const Eigen::Vector3d n = du.cross(dv).normalized();
  return n.z() > 0.0 ? Eigen::Vector3d(-n) : n;
}

// One fit of heights over the plane through `t.origin` across `t.normal`.
bool fit_heights(const depth::DepthImage& frame, const geometry::Ellipse& rim,
                 const DepthQuadric& surface, TangentQuadric& t) noexcept {
  geometry::orthonormal_base(t.normal, t.e1, t.e2);
  const double scale = rim.a * t.origin.z() / frame.intrinsics.fx;
  Matrix6 h = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  const Window w = window_around(frame, rim, kOuterRing);
  for (std::uint32_t v = w.v0; v < w.v1; v += w.step) {
    for (std::uint32_t u = w.u0; u < w.u1; u += w.step) {
      const double z = frame.count_at(u, v) * frame.mm_per_count;
      const double relative = rim.relative_radius(u, v);
      if (z == 0.0 || relative < kInnerRing || relative > kOuterRing ||
          std::abs(z - surface.z(u, v)) > surface.gate_mm) {
        continue;
      }
      const Eigen::Vector3d p = ray(frame.intrinsics, u, v) * z - t.origin;
      const Vector6 r = quadratic(t.e1.dot(p) / scale, t.e2.dot(p) / scale);
      h.noalias() += r * r.transpose();
      g += r * t.normal.dot(p);
    }
  }
  Vector6 to_mm;
  to_mm << 1.0, 1.0 / scale, 1.0 / scale, Eigen::Vector3d::Constant(1.0 / (scale * scale));
  t.q = Vector6(h.ldlt().solve(g)).cwiseProduct(to_mm);
  return t.q.allFinite();
}

}  // namespace

double DepthQuadric::z(double pu, double pv) const noexcept {
  return q.dot(quadratic((pu - u) / scale, (pv - v) / scale));
}

double TangentQuadric::height(double x, double y) const noexcept { return q.dot(quadratic(x, y)); }

Eigen::Vector3d TangentQuadric::meet(const depth::Intrinsics& k, double u,
                                     double v) const noexcept {
  const Eigen::Vector3d r = ray(k, u, v);
  double t = normal.dot(origin) / normal.dot(r);
  for (int round = 0; round < 4; ++round) {
    const Eigen::Vector3d p = r * t - origin;
    const double x = e1.dot(p);
    const double y = e2.dot(p);
    const double slope_x = q(1) + 2.0 * q(3) * x + q(4) * y;
    const double slope_y = q(2) + q(4) * x + 2.0 * q(5) * y;
    t -= (normal.dot(p) - height(x, y)) /
         (normal.dot(r) - slope_x * e1.dot(r) - slope_y * e2.dot(r));
  }
  return r * t;
}

std::optional<RingSurface> fit_ring(const depth::DepthImage& frame,
                                    const geometry::Ellipse& rim) noexcept {
  RingSurface out;
  if (!fit_surface(frame, rim, out.depth)) {
    return std::nullopt;
  }
  TangentQuadric& t = out.tangent;
  t.origin = ray(frame.intrinsics, rim.u, rim.v) * out.depth.z(rim.u, rim.v);
  t.normal = normal_at_centre(frame.intrinsics, out.depth);
  for (int round = 0; round < 2; ++round) {
    if (!fit_heights(frame, rim, out.depth, t)) {
      return std::nullopt;
    }
    if (round == 0) {
      t.origin += t.normal * t.q(0);
      t.normal = (t.normal - t.e1 * t.q(1) - t.e2 * t.q(2)).normalized();
    }
  }
  return out;
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

}  // namespace dseam::markers
