// SPDX-License-Identifier: Apache-2.0
#include "markers/ellipse_edge.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "dseam/geometry/symmetric_matrix.hpp"

namespace dseam::markers {
namespace {

constexpr std::size_t kProfiles = 48;
constexpr std::size_t kMaxSamples = 33;
constexpr double kStepPx = 0.5;
constexpr int kRounds = 3;

struct EdgePoint {
  double u = 0.0;
  double v = 0.0;
  double width_px = 0.0;
  double step = 0.0;
};

struct Edges {
  std::array<EdgePoint, kProfiles> points;
  std::size_t count = 0;
};

double gray_between(const depth::DepthImage& frame, double u, double v) noexcept {
  const auto u0 = static_cast<std::uint32_t>(u);
  const auto v0 = static_cast<std::uint32_t>(v);
  const double fu = u - u0;
  const double fv = v - v0;
  const double upper = (1.0 - fu) * frame.gray_at(u0, v0) + fu * frame.gray_at(u0 + 1, v0);
  const double lower = (1.0 - fu) * frame.gray_at(u0, v0 + 1) + fu * frame.gray_at(u0 + 1, v0 + 1);
  return (1.0 - fv) * upper + fv * lower;
}

bool inside_image(const depth::DepthImage& frame, double u, double v) noexcept {
  return u >= 0.0 && v >= 0.0 && u < frame.intrinsics.width - 1.0 &&
         v < frame.intrinsics.height - 1.0;
}

// One gray profile across the rim, from inside to outside, turned so that it rises.
struct Profile {
  std::array<double, kMaxSamples> gray;
  std::size_t count = 0;
  double first_px = 0.0;  // Offset of the first sample from the rim, negative inside.
};

// The step that has the profile's area: it averages noise, where a single crossing does not.
double equal_area_edge(const Profile& p, double low, double high) noexcept {
  double inside = 0.0;
  for (std::size_t i = 0; i < p.count; ++i) {
    const double share = std::clamp((high - p.gray[i]) / (high - low), 0.0, 1.0);
    inside += i == 0 || i + 1 == p.count ? 0.5 * share : share;
  }
  return p.first_px + inside * kStepPx;
}

double steepest(const Profile& p) noexcept {
  double slope = 0.0;
  for (std::size_t i = 0; i + 2 < p.count; ++i) {
    slope = std::max(slope, (p.gray[i + 2] - p.gray[i]) / (2.0 * kStepPx));
  }
  return slope;
}

Profile read_profile(const depth::DepthImage& frame, const Eigen::Vector2d& rim,
                     const Eigen::Vector2d& normal, double reach_px, double sign) noexcept {
  Profile p;
  p.first_px = -reach_px;
  const auto samples = static_cast<std::size_t>(2.0 * reach_px / kStepPx) + 1;
  for (std::size_t i = 0; i < std::min(samples, kMaxSamples); ++i) {
    const Eigen::Vector2d q = rim + normal * (p.first_px + static_cast<double>(i) * kStepPx);
    if (!inside_image(frame, q.x(), q.y())) {
      return {};
    }
    p.gray[p.count++] = sign * gray_between(frame, q.x(), q.y());
  }
  return p;
}

std::optional<EdgePoint> find_edge(const depth::DepthImage& frame, const Eigen::Vector2d& rim,
                                   const Eigen::Vector2d& normal, double reach_px,
                                   double sign) noexcept {
  const Profile p = read_profile(frame, rim, normal, reach_px, sign);
  if (p.count < 5) {
    return std::nullopt;
  }
  const double low = (p.gray[0] + p.gray[1]) / 2.0;
  const double high = (p.gray[p.count - 1] + p.gray[p.count - 2]) / 2.0;
  constexpr double kMinStep = 8.0;
  if (high - low < kMinStep) {
    return std::nullopt;
  }
  const Eigen::Vector2d q = rim + normal * equal_area_edge(p, low, high);
  return EdgePoint{q.x(), q.y(), (high - low) / std::max(steepest(p), 1e-6), high - low};
}

Edges find_edges(const depth::DepthImage& frame, const geometry::Ellipse& e, double sign) noexcept {
  Edges edges;
  const double reach = std::clamp(0.8 * e.b, 2.0, 5.0);
  const Eigen::Vector2d long_axis(std::cos(e.angle_rad), std::sin(e.angle_rad));
  const Eigen::Vector2d short_axis(-long_axis.y(), long_axis.x());
  for (std::size_t k = 0; k < kProfiles; ++k) {
    const double t = 2.0 * std::numbers::pi * static_cast<double>(k) / kProfiles;
    const Eigen::Vector2d rim = Eigen::Vector2d(e.u, e.v) + long_axis * (e.a * std::cos(t)) +
                                short_axis * (e.b * std::sin(t));
    const Eigen::Vector2d normal =
        (long_axis * (std::cos(t) / e.a) + short_axis * (std::sin(t) / e.b)).normalized();
    if (const auto edge = find_edge(frame, rim, normal, reach, sign)) {
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

double sampson(const Conic& q, double x, double y) noexcept {
  const double gx = 2.0 * q(0) * x + q(1) * y + q(3);
  const double gy = q(1) * x + 2.0 * q(2) * y + q(4);
  return (q.dot(row(x, y)) - 1.0) / std::max(std::hypot(gx, gy), 1e-9);
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
      const double x = (edges.points[i].u - frame.u) / frame.a;
      const double y = (edges.points[i].v - frame.v) / frame.a;
      const double s = sampson(q, x, y) / gate;
      const double slope =
          std::hypot(2.0 * q(0) * x + q(1) * y + q(3), q(1) * x + 2.0 * q(2) * y + q(4));
      const double robust = s * s < 1.0 ? (1.0 - s * s) * (1.0 - s * s) : 0.0;
      const double w = robust / std::max(slope * slope, 1e-6);
      h.noalias() += w * row(x, y) * row(x, y).transpose();
      g += w * row(x, y);
    }
    q = h.ldlt().solve(g);
    double squares = 0.0;
    double weight = 1e-12;
    for (std::size_t i = 0; i < edges.count; ++i) {
      const double d = sampson(q, (edges.points[i].u - frame.u) / frame.a,
                               (edges.points[i].v - frame.v) / frame.a);
      const double w = std::abs(d) < gate ? 1.0 : 0.0;
      squares += w * d * d;
      weight += w;
    }
    rms = std::sqrt(squares / weight);
    gate = std::max(4.0 * rms, 0.1 / frame.a);
  }
  return {q.allFinite() ? to_ellipse(q, frame) : std::nullopt, rms * frame.a};
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

EllipseEdge refine_ellipse(const depth::DepthImage& frame, const geometry::Ellipse& start,
                           bool dark_inside) noexcept {
  EllipseEdge out;
  out.ellipse = start;
  const double sign = dark_inside ? 1.0 : -1.0;
  for (int round = 0; round < kRounds; ++round) {
    Edges edges = find_edges(frame, out.ellipse, sign);
    out.rim_seen = static_cast<double>(edges.count) / kProfiles;
    if (edges.count < kProfiles / 2) {
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
    out.edge_width_px = median_width(edges);
  }
  out.flatness = flatness(frame, out.ellipse, out.contrast);
  out.converged = true;
  return out;
}

}  // namespace dseam::markers
