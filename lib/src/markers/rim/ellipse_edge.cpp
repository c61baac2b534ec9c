// SPDX-License-Identifier: Apache-2.0
#include "markers/rim/ellipse_edge.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "dseam/geometry/symmetric_matrix.hpp"
#include "markers/rim/gray_profile.hpp"

namespace dseam::markers {
namespace {

constexpr int kRounds = 3;

struct Edges {
  std::array<EdgePoint, EllipseEdge::kProfiles> points;
  std::size_t count = 0;
};

Edges find_edges(const depth::DepthImage& frame, const geometry::Ellipse& e, double sign) noexcept {
  Edges edges;
  const double reach = std::clamp(0.8 * e.b, 2.0, 5.0);
  const Shading shading = shading_about(frame, e, reach);
  const Eigen::Vector2d long_axis(std::cos(e.angle_rad), std::sin(e.angle_rad));
  const Eigen::Vector2d short_axis(-long_axis.y(), long_axis.x());
  for (std::size_t k = 0; k < EllipseEdge::kProfiles; ++k) {
    const double t = 2.0 * std::numbers::pi * static_cast<double>(k) / EllipseEdge::kProfiles;
    const Eigen::Vector2d rim = Eigen::Vector2d(e.u, e.v) + long_axis * (e.a * std::cos(t)) +
                                short_axis * (e.b * std::sin(t));
    const Eigen::Vector2d normal =
        (long_axis * (std::cos(t) / e.a) + short_axis * (std::sin(t) / e.b)).normalized();
    if (const auto edge = find_edge(frame, rim, normal, reach, shading, sign)) {
      edges.points[edges.count++] = *edge;
    }
  }
  return edges;
}

// a x^2 + b x y + c y^2 + d x + e y = 1 about the start's centre, in units of its half axis.
using Conic = Eigen::Matrix<double, 5, 1>;

Conic row(double x, double y) noexcept {
  Conic r;
  r << x * x, x * y, y * y, x, y;
  return r;
}

double squared_slope(const Conic& q, double x, double y) noexcept {
  const double gx = 2.0 * q(0) * x + q(1) * y + q(3);
  const double gy = q(1) * x + 2.0 * q(2) * y + q(4);
  return gx * gx + gy * gy;
}

double sampson(const Conic& q, double x, double y) noexcept {
  return (q.dot(row(x, y)) - 1.0) / std::max(std::sqrt(squared_slope(q, x, y)), 1e-9);
}

std::optional<geometry::Ellipse> to_ellipse(const Conic& q,
                                            const geometry::Ellipse& frame) noexcept {
  Eigen::Matrix2d m;
  m << q(0), q(1) / 2.0, q(1) / 2.0, q(2);
  if (!(m.determinant() > 0.0) || !(q(0) > 0.0)) {
    return std::nullopt;
  }
  const Eigen::Vector2d centre = -0.5 * m.inverse() * q.tail<2>();
  const double scale = 1.0 + centre.dot(m * centre);
  const auto eigen = geometry::eigen_of_symmetric<2>(m);
  const Eigen::Vector2d axes = (scale / eigen.values.array()).sqrt();
  const Eigen::Vector2d direction = eigen.vectors.col(0);
  return geometry::Ellipse{frame.u + frame.a * centre.x(), frame.v + frame.a * centre.y(),
                           frame.a * axes(0), frame.a * axes(1),
                           std::atan2(direction.y(), direction.x())};
}

struct ConicFit {
  std::optional<geometry::Ellipse> ellipse;
  double rms_px = 0.0;
};

ConicFit fit_conic(const Edges& edges, const geometry::Ellipse& frame) noexcept {
  Conic q;
  q << 1.0, 0.0, 1.0, 0.0, 0.0;
  double gate = 1e9;
  double rms = 0.0;
  for (int round = 0; round < 5; ++round) {
    Eigen::Matrix<double, 5, 5> h = Eigen::Matrix<double, 5, 5>::Zero();
    Conic g = Conic::Zero();
    for (std::size_t i = 0; i < edges.count; ++i) {
      const double x = (edges.points[i].p_px.x() - frame.u) / frame.a;
      const double y = (edges.points[i].p_px.y() - frame.v) / frame.a;
      const double s = sampson(q, x, y) / gate;
      const double robust = s * s < 1.0 ? (1.0 - s * s) * (1.0 - s * s) : 0.0;
      const double w = robust / std::max(squared_slope(q, x, y), 1e-6);
      h.noalias() += w * row(x, y) * row(x, y).transpose();
      g += w * row(x, y);
    }
    q = h.ldlt().solve(g);
    double squares = 0.0;
    double weight = 1e-12;
    for (std::size_t i = 0; i < edges.count; ++i) {
      const double d = sampson(q, (edges.points[i].p_px.x() - frame.u) / frame.a,
                               (edges.points[i].p_px.y() - frame.v) / frame.a);
      const double w = std::abs(d) < gate ? 1.0 : 0.0;
      squares += w * d * d;
      weight += w;
    }
    rms = std::sqrt(squares / weight);
    gate = std::max(4.0 * rms, 0.1 / frame.a);
  }
  return {q.allFinite() ? to_ellipse(q, frame) : std::nullopt, rms * frame.a};
}

// The edges that lie on the ellipse.
void keep_rim(const Edges& edges, EllipseEdge& out) noexcept {
  const double gate = std::max(4.0 * out.rms_px, 0.1);
  const geometry::EllipseGauge gauge(out.ellipse);
  std::array<double, EllipseEdge::kProfiles> residuals{};
  out.num_rim = 0;
  for (std::size_t i = 0; i < edges.count; ++i) {
    const Eigen::Vector2d& p = edges.points[i].p_px;
    const Eigen::Vector2d from = p - Eigen::Vector2d(out.ellipse.u, out.ellipse.v);
    const double off = (1.0 - 1.0 / gauge.radius(p.x(), p.y())) * from.norm();
    if (std::abs(off) < gate) {
      residuals[out.num_rim] = off;
      out.rim_px[out.num_rim++] = p;
    }
  }
  out.sigma_px = scatter_of(std::span(residuals).first(out.num_rim)).sigma_of_mean();
}

double median_width(Edges& edges) noexcept {
  const auto middle = edges.points.begin() + static_cast<std::ptrdiff_t>(edges.count / 2);
  std::nth_element(edges.points.begin(), middle,
                   edges.points.begin() + static_cast<std::ptrdiff_t>(edges.count),
                   [](const EdgePoint& a, const EdgePoint& b) { return a.width_px < b.width_px; });
  return middle->width_px;
}

// How much the step varies along the rim, as a share of it: texture varies, a disc on paint does
// not.
double unevenness(const Edges& edges, double mean) noexcept {
  double squares = 0.0;
  for (std::size_t i = 0; i < edges.count; ++i) {
    squares += (edges.points[i].step - mean) * (edges.points[i].step - mean);
  }
  const double n = static_cast<double>(std::max<std::size_t>(edges.count, 1));
  return std::sqrt(squares / n) / std::max(mean, 1.0);
}

double mean_step(const Edges& edges) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < edges.count; ++i) {
    sum += edges.points[i].step;
  }
  return sum / static_cast<double>(std::max<std::size_t>(edges.count, 1));
}

// A disc has the same gray at its centre as half-way to its rim, up to shading, which is odd.
double flatness(const depth::DepthImage& frame, const geometry::Ellipse& e, double step) noexcept {
  double ring = 0.0;
  constexpr int kPoints = 8;
  for (int k = 0; k < kPoints; ++k) {
    const double t = 2.0 * std::numbers::pi * k / kPoints;
    const double u = e.u + 0.5 * e.b * std::cos(t);
    const double v = e.v + 0.5 * e.b * std::sin(t);
    ring += inside_image(frame, u, v) ? gray_between(frame, u, v) / kPoints : 0.0;
  }
  return std::abs(ring - gray_between(frame, e.u, e.v)) / std::max(step, 1.0);
}

}  // namespace

double RimScatter::sigma_of_mean() const noexcept { return rms / std::sqrt(independent); }

RimScatter scatter_of(std::span<const double> residuals) noexcept {
  constexpr double kMinIndependent = 2.0;
  constexpr double kMaxIndependent = 12.0;  // Neighbouring profiles share pixels.
  RimScatter out;
  const std::size_t n = residuals.size();
  double squares = 0.0;
  double products = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    squares += residuals[i] * residuals[i];
    products += residuals[i] * residuals[(i + 1) % n];
  }
  if (!(squares > 0.0)) {
    return out;
  }
  out.rms = std::sqrt(squares / static_cast<double>(n));
  const double like = std::clamp(products / squares, 0.0, 0.999);
  out.independent = std::clamp(static_cast<double>(n) * (1.0 - like) / (1.0 + like),
                               kMinIndependent, kMaxIndependent);
  return out;
}

EllipseEdge refine_ellipse(const depth::DepthImage& frame, const geometry::Ellipse& start,
                           bool dark_inside) noexcept {
  EllipseEdge out;
  out.ellipse = start;
  const double sign = dark_inside ? 1.0 : -1.0;
  for (int round = 0; round < kRounds; ++round) {
    Edges edges = find_edges(frame, out.ellipse, sign);
    out.rim_seen = static_cast<double>(edges.count) / EllipseEdge::kProfiles;
    if (edges.count < EllipseEdge::kProfiles / 2) {
      return out;
    }
    const ConicFit fit = fit_conic(edges, out.ellipse);
    if (!fit.ellipse || fit.ellipse->a > 2.0 * start.a || fit.ellipse->b < 0.4 * start.b ||
        !inside_image(frame, fit.ellipse->u, fit.ellipse->v)) {
      return out;
    }
    out.ellipse = *fit.ellipse;
    out.rms_px = fit.rms_px;
    out.contrast = mean_step(edges);
    out.unevenness = unevenness(edges, out.contrast);
    keep_rim(edges, out);
    out.edge_width_px = median_width(edges);
  }
  out.flatness = flatness(frame, out.ellipse, out.contrast);
  out.converged = true;
  return out;
}

}  // namespace dseam::markers
