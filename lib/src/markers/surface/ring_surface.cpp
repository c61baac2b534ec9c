// SPDX-License-Identifier: Apache-2.0
#include "markers/surface/ring_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "dseam/geometry/cylinder_fit.hpp"
#include "markers/surface/image_window.hpp"
#include "markers/surface/quadratic_sums.hpp"

namespace dseam::markers {
namespace {

constexpr double kMaxGateMm = 2.0;

Vector6 quadratic(double x, double y) noexcept {
  Vector6 r;
  r << 1.0, x, y, x * x, x * y, y * y;
  return r;
}

Eigen::Vector3d ray(const depth::Intrinsics& k, double u, double v) noexcept {
  return {(u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0};
}

Vector6 from_base(const RingPixels& ring, Vector6 q) noexcept {
  q(0) -= ring.base_mm();
  return q;
}

// What the ring's depth leaves of the surface, where it lies near it.
QuadraticSums residuals_of(const RingPixels& ring, const Vector6& q, double gate_mm) noexcept {
  QuadraticSums sums;
  const QuadraticLanes surface(from_base(ring, q));
  const lanes::FloatLanes gate = lanes::splat(static_cast<float>(gate_mm));
  ring.for_each_eight([&](const RingPixels::Eight& p) {
    const lanes::FloatLanes residual = p.beyond_mm - surface.at(p.x, p.y);
    sums.add(p.x, p.y, residual, lanes::magnitude(residual) <= gate);
  });
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

bool fit_surface(const depth::DepthImage& frame, const geometry::Ellipse& rim, RingPixels& ring,
                 DepthQuadric& surface) noexcept {
  surface.u = rim.u;
  surface.v = rim.v;
  surface.scale = rim.a;
  surface.q(0) = start_depth(frame, rim);
  if (!(surface.q(0) > 0.0)) {
    return false;
  }
  ring.gather(frame, rim, surface.q(0));
  // The first gate lets a steep surface in; the last keeps flying pixels out.
  double gate = std::max(kMaxGateMm, 10.0 * rim.a * surface.q(0) / frame.intrinsics.fx);
  for (int round = 0; round < 6; ++round) {
    const QuadraticSums sums = residuals_of(ring, surface.q, gate);
    if (sums.count() < 24 || 2 * sums.count() < ring.size()) {
      return false;
    }
    surface.q += sums.solve();
    const double rms = std::sqrt(sums.mean_square());
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

// One fit of heights over the plane through `t.origin` across `t.normal`. In floats, a place is
// what its ray differs from the centre's and its depth from the base.
bool fit_heights(const depth::Intrinsics& k, const RingPixels& ring, const DepthQuadric& surface,
                 TangentQuadric& t) noexcept {
  using lanes::splat;
  geometry::orthonormal_base(t.normal, t.e1, t.e2);
  const double scale = surface.scale * t.origin.z() / k.fx;
  const QuadraticLanes depth(from_base(ring, surface.q));
  const Eigen::Vector3d centre = ray(k, surface.u, surface.v);
  const Eigen::Vector3f start = (centre * ring.base_mm() - t.origin).cast<float>();
  QuadraticSums heights;
  ring.for_each_eight([&](const RingPixels::Eight& p) {
    const lanes::FloatLanes z = splat(static_cast<float>(ring.base_mm())) + p.beyond_mm;
    const auto across = [&](double ray_of_centre, double of_half_axis, float from_origin,
                            const lanes::FloatLanes& half_axes) noexcept {
      return splat(from_origin) + splat(static_cast<float>(ray_of_centre)) * p.beyond_mm +
             splat(static_cast<float>(of_half_axis)) * half_axes * z;
    };
    const lanes::FloatLanes px = across(centre.x(), surface.scale / k.fx, start.x(), p.x);
    const lanes::FloatLanes py = across(centre.y(), surface.scale / k.fy, start.y(), p.y);
    const lanes::FloatLanes pz = splat(start.z()) + p.beyond_mm;
    const auto along = [&](const Eigen::Vector3d& axis) noexcept {
      const Eigen::Vector3f d = axis.cast<float>();
      return splat(d.x()) * px + splat(d.y()) * py + splat(d.z()) * pz;
    };
    const lanes::FloatLanes off = lanes::magnitude(p.beyond_mm - depth.at(p.x, p.y));
    heights.add(along(t.e1 / scale), along(t.e2 / scale), along(t.normal),
                off <= splat(static_cast<float>(surface.gate_mm)));
  });
  Vector6 to_mm;
  to_mm << 1.0, 1.0 / scale, 1.0 / scale, Eigen::Vector3d::Constant(1.0 / (scale * scale));
  t.q = heights.solve().cwiseProduct(to_mm);
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

std::optional<RingSurface> fit_ring(const depth::DepthImage& frame, const geometry::Ellipse& rim,
                                    RingPixels& ring) noexcept {
  RingSurface out;
  if (!fit_surface(frame, rim, ring, out.depth)) {
    return std::nullopt;
  }
  TangentQuadric& t = out.tangent;
  t.origin = ray(frame.intrinsics, rim.u, rim.v) * out.depth.z(rim.u, rim.v);
  t.normal = normal_at_centre(frame.intrinsics, out.depth);
  for (int round = 0; round < 2; ++round) {
    if (!fit_heights(frame.intrinsics, ring, out.depth, t)) {
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
  constexpr double kInside = 0.8;
  const geometry::EllipseGauge gauge(rim);
  double valid = 0.0;
  double off = 0.0;
  for_each_around(frame, rim, kInside, [&](std::uint32_t u, std::uint32_t v) {
    const std::uint16_t count = frame.count_at(u, v);
    if (count == 0 || gauge.squared_radius(u, v) > kInside * kInside) {
      return;
    }
    valid += 1.0;
    off += std::abs(count * frame.mm_per_count - s.z(u, v)) > max_depth_mm ? 1.0 : 0.0;
  });
  return off > 3.0 && off > 0.25 * valid;
}

}  // namespace dseam::markers
