// SPDX-License-Identifier: Apache-2.0
#include "dseam/geometry/cylinder_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "dseam/geometry/robust.hpp"
#include "dseam/geometry/symmetric_matrix.hpp"

namespace dseam::geometry {
namespace {

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

// Tukey's 4.685 sigma (95 % efficient), and the weighted rms under that gate is 0.91 sigma.
constexpr double kGateInRms = 4.685 / 0.91;

struct NormalEquations {
  Matrix5 h = Matrix5::Zero();
  Vector5 g = Vector5::Zero();
  double weight = 0.0;
  double squares = 0.0;
  double psi_squares = 0.0;  // Of the estimator's influence, and of its slope: they turn the
  double psi_slopes = 0.0;   // inverse of h into a covariance.
  std::uint32_t inliers = 0;

  [[nodiscard]] double rms() const noexcept {
    return weight > 0.0 ? std::sqrt(squares / weight) : 0.0;
  }
};

Eigen::Vector3d centroid(const PointSpans& points) noexcept {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (const Eigen::Vector3d p = points[i]; p.allFinite()) {
      sum += p;
      count += 1.0;
    }
  }
  return count > 0.0 ? Eigen::Vector3d(sum / count) : sum;
}

void slide_to_foot(Cylinder& c, const Eigen::Vector3d& p) noexcept {
  c.point_mm += c.axis * c.axis.dot(p - c.point_mm);
}

void add_point(const Eigen::Vector3d& p, const CylinderFit& fit, double gate,
               NormalEquations& out) noexcept {
  const Eigen::Vector3d d = p - fit.cylinder.point_mm;
  const double along = d.dot(fit.cylinder.axis);
  const Eigen::Vector3d across = d - along * fit.cylinder.axis;
  const double rho = across.norm();
  const double residual = rho - fit.cylinder.radius_mm;
  if (!(std::abs(residual) < gate) || rho < 1e-9) {
    return;
  }
  const Eigen::Vector3d n = across / rho;
  Vector5 j;
  j << -n.dot(fit.e1), -n.dot(fit.e2), -along * n.dot(fit.e1), -along * n.dot(fit.e2), -1.0;
  const double w = tukey(residual / gate);
  out.h.noalias() += w * j * j.transpose();
  out.g += w * residual * j;
  out.weight += w;
  out.squares += w * residual * residual;
  out.psi_squares += w * w * residual * residual;
  const double s = residual * residual / (gate * gate);
  out.psi_slopes += (1.0 - s) * (1.0 - 5.0 * s);
  ++out.inliers;
}

NormalEquations accumulate(const PointSpans& points, const CylinderFit& fit, double gate) noexcept {
  NormalEquations out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    add_point(points[i], fit, gate, out);
  }
  return out;
}

bool is_small(const Vector5& step) noexcept {
  return std::hypot(step(0), step(1)) < 1e-5 && std::abs(step(4)) < 1e-5 &&
         std::hypot(step(2), step(3)) < 1e-8;
}

// The lengths that make the five parameters comparable: shifts in mm, tilts at the cloud's reach.
Matrix5 scaled(const Matrix5& h) noexcept {
  const Vector5 s = h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  return s.asDiagonal() * h * s.asDiagonal();
}

bool determined(const Matrix5& h) noexcept {
  constexpr double kMinRatio = 1e-9;
  return h.diagonal().minCoeff() > 0.0 && eigen_of_symmetric<5>(scaled(h)).values(0) > kMinRatio;
}

void apply(const Vector5& step, const Eigen::Vector3d& pivot, CylinderFit& fit) noexcept {
  Cylinder& c = fit.cylinder;
  c.point_mm += fit.e1 * step(0) + fit.e2 * step(1);
  c.axis = (c.axis + fit.e1 * step(2) + fit.e2 * step(3)).normalized();
  c.radius_mm += step(4);
  slide_to_foot(c, pivot);
  orthonormal_base(c.axis, fit.e1, fit.e2);
}

bool plausible(const Cylinder& c, const SurfaceFitConfig& config) noexcept {
  return c.point_mm.allFinite() && c.axis.allFinite() && c.radius_mm >= config.min_radius_mm &&
         c.radius_mm <= config.max_radius_mm;
}

Matrix5 covariance(const NormalEquations& sums, const SurfaceFitConfig& config) noexcept {
  const double n = static_cast<double>(sums.inliers);
  const double slope = std::max(sums.psi_slopes / n, 0.1);
  const double variance = sums.psi_squares / std::max(n - 5.0, 1.0) / (slope * slope);
  return inverse_of_symmetric<5>(sums.h) * (sums.weight / n) * variance *
         std::max(1.0, config.points_per_independent_error);
}

}  // namespace

double Cylinder::distance_mm(const Eigen::Vector3d& p) const noexcept {
  return axis.cross(p - point_mm).norm() - radius_mm;
}

Eigen::Vector3d Cylinder::normal(const Eigen::Vector3d& p) const noexcept {
  const Eigen::Vector3d d = p - point_mm;
  const Eigen::Vector3d across = d - axis * axis.dot(d);
  const double length = across.norm();
  return length > 0.0 ? Eigen::Vector3d(across / length) : Eigen::Vector3d::Zero();
}

void orthonormal_base(const Eigen::Vector3d& axis, Eigen::Vector3d& e1,
                      Eigen::Vector3d& e2) noexcept {
  Eigen::Index smallest = 0;
  axis.cwiseAbs().minCoeff(&smallest);
  e1 = Eigen::Vector3d::Unit(smallest).cross(axis).normalized();
  e2 = axis.cross(e1);
}

std::optional<Cylinder> guess_cylinder(const PointSpans& points,
                                       const PointSpans& normals) noexcept {
  const Eigen::Vector3d pivot = centroid(points);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d sum_p = Eigen::Vector3d::Zero();
  double cross_pn = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i] - pivot;
    const Eigen::Vector3d n = normals[i];
    if (!p.allFinite() || !n.allFinite() || n.squaredNorm() < 0.5) {
      continue;
    }
    scatter.noalias() += n * n.transpose();
    sum_n += n;
    sum_p += p;
    cross_pn += p.dot(n);
    count += 1.0;
  }
  if (count < 3.0) {
    return std::nullopt;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter / count);
  const Eigen::Vector3d axis = solver.eigenvectors().col(0);
  // Least squares of p = centre + radius n across the axis, with |n| = 1.
  const double spread = 1.0 - (sum_n / count).squaredNorm();
  constexpr double kMinSpread = 1e-4;  // About a degree of arc: flatter is a plane.
  if (spread < kMinSpread || solver.eigenvalues()(1) < kMinSpread) {
    return std::nullopt;
  }
  const double radius = (cross_pn / count - sum_p.dot(sum_n) / (count * count)) / spread;
  if (!std::isfinite(radius) || radius == 0.0) {
    return std::nullopt;
  }
  Cylinder guess{pivot + (sum_p - radius * sum_n) / count, axis, std::abs(radius)};
  slide_to_foot(guess, pivot);
  return guess;
}

CylinderFit fit_cylinder(const PointSpans& points, const Cylinder& start,
                         const SurfaceFitConfig& config) noexcept {
  CylinderFit fit;
  fit.cylinder = start;
  const Eigen::Vector3d pivot = centroid(points);
  slide_to_foot(fit.cylinder, pivot);
  orthonormal_base(fit.cylinder.axis, fit.e1, fit.e2);
  double gate = config.start_gate_mm;
  for (fit.iterations = 0; fit.iterations < config.max_iterations; ++fit.iterations) {
    const NormalEquations sums = accumulate(points, fit, gate);
    fit.num_inliers = sums.inliers;
    fit.rms_mm = sums.rms();
    if (sums.inliers < config.min_points) {
      fit.state = FitState::kTooFewPoints;
      return fit;
    }
    if (!determined(sums.h)) {
      fit.state = FitState::kDegenerate;
      return fit;
    }
    fit.covariance = covariance(sums, config);
    const Vector5 step = -sums.h.llt().solve(sums.g);
    apply(step, pivot, fit);
    if (!plausible(fit.cylinder, config)) {
      fit.state = FitState::kDegenerate;
      return fit;
    }
    const double next_gate = std::clamp(kGateInRms * sums.rms(), config.final_gate_mm, gate);
    const bool settled = next_gate > 0.999 * gate && is_small(step);
    gate = next_gate;
    if (settled) {
      fit.state = FitState::kConverged;
      return fit;
    }
  }
  fit.state = FitState::kNotConverged;
  return fit;
}

}  // namespace dseam::geometry
