// SPDX-License-Identifier: Apache-2.0
#include "splice/pipes/pipe_form.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "dseam/geometry/robust.hpp"
#include "dseam/geometry/symmetric_matrix.hpp"
#include "splice/network/surface_ties.hpp"

namespace dseam::splice {
namespace {

// Two shifts, two tilts, radius; then the section's second harmonic.
using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;
using Depths7 = Eigen::Matrix<double, 7, 3>;

constexpr double kGateInRms = 6.0;
constexpr double kSmallestGateMm = 0.02;
constexpr double kOvalChiSquaredLimit = 18.4;  // One round pipe in 10,000 is called oval.

struct Sums {
  Matrix7 h = Matrix7::Zero();
  Vector7 g = Vector7::Zero();
  Depths7 depths = Depths7::Zero();  // What bowl and offset of the depths add to g.
  double weight = 0.0;
  double squares = 0.0;
  std::array<double, 4> products{};  // Of residuals 0, 1, 2 and 3 points apart.
  std::array<double, 4> last{};

  void add(const Vector7& j, double residual, double w) noexcept {
    h.noalias() += w * j * j.transpose();
    g += w * residual * j;
    weight += w;
    squares += w * residual * residual;
    last = {residual, last[0], last[1], last[2]};
    for (std::size_t lag = 0; lag < last.size(); ++lag) {
      products[lag] += residual * last[lag];
    }
  }
  // Errors that hang together along a row do so across rows as well.
  [[nodiscard]] double per_independent() const noexcept {
    const double in_a_row =
        1.0 + 2.0 * (products[1] + products[2] + products[3]) / std::max(products[0], 1e-300);
    return in_a_row > 1.0 ? in_a_row * in_a_row : 1.0;
  }
  [[nodiscard]] double rms_mm() const noexcept {
    return std::sqrt(squares / std::max(weight, 1e-300));
  }
};

struct Section {
  double cosine_mm = 0.0;  // Of the radius' second harmonic, from e1 on.
  double sine_mm = 0.0;
};

// How a point goes outwards for each mm of bowl and offset.
Eigen::Vector3d lift(const depth::Intrinsics& k, const Eigen::Vector3d& p,
                     const Eigen::Vector3d& outward) noexcept {
  const Eigen::Vector3d ray = p / p.z();
  const Eigen::Vector2d shape = bowl_shape(k, k.fx * ray.x() + k.cx, k.fy * ray.y() + k.cy);
  return outward.dot(ray) * Eigen::Vector3d(shape.x(), shape.y(), 1.0);
}

Sums accumulate(const geometry::PointSpans& points, const depth::Intrinsics& k,
                const geometry::CylinderFit& fit, const Section& section, double gate_mm) noexcept {
  Sums sums;
  const geometry::Cylinder& c = fit.cylinder;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d d = points[i] - c.point_mm;
    const double along = d.dot(c.axis);
    const Eigen::Vector2d across(d.dot(fit.e1), d.dot(fit.e2));
    const double rho = across.norm();
    const Eigen::Vector2d n = across / rho;
    const double twice_cosine = n.x() * n.x() - n.y() * n.y();
    const double twice_sine = 2.0 * n.x() * n.y();
    const double residual =
        rho - c.radius_mm - section.cosine_mm * twice_cosine - section.sine_mm * twice_sine;
    if (!(std::abs(residual) < gate_mm)) {
      continue;
    }
    Vector7 j;
    j << -n, -along * n, -1.0, -twice_cosine, -twice_sine;
    const double w = geometry::tukey(residual / gate_mm);
    sums.add(j, residual, w);
    sums.depths += w * j * lift(k, points[i], fit.e1 * n.x() + fit.e2 * n.y()).transpose();
  }
  return sums;
}

void move(const Vector7& step, geometry::CylinderFit& fit) noexcept {
  geometry::Cylinder& c = fit.cylinder;
  c.point_mm += fit.e1 * step(0) + fit.e2 * step(1);
  c.axis = (c.axis + fit.e1 * step(2) + fit.e2 * step(3)).normalized();
  c.radius_mm += step(4);
  // The base turns with the axis, and the section keeps its directions.
  fit.e1 = (fit.e1 - c.axis * c.axis.dot(fit.e1)).normalized();
  fit.e2 = c.axis.cross(fit.e1);
}

// Gauss-Newton in progress.
struct FormFit {
  const geometry::PointSpans& points;
  const depth::Intrinsics& k;
  double ovality_sigma_mm;
  Pipe& pipe;
  double least_per_independent = pipe.patches_per_independent;
  Section section{};
  Matrix7 covariance = Matrix7::Zero();
  double gate_mm = 0.0;

  // False where the points do not determine it.
  bool step() noexcept {
    const Sums sums = accumulate(points, k, pipe.fit, section, gate_mm);
    pipe.fit.rms_mm = sums.rms_mm();
    pipe.patches_per_independent = std::max(least_per_independent, sums.per_independent());
    const double variance =
        std::max(1e-12, sums.rms_mm() * sums.rms_mm() * pipe.patches_per_independent);
    const double prior = 1.0 / (ovality_sigma_mm * ovality_sigma_mm);
    Matrix7 h = sums.h / variance;
    h.diagonal().tail<2>().array() += prior;
    Vector7 g = sums.g / variance;
    g.tail<2>() += prior * Eigen::Vector2d(section.cosine_mm, section.sine_mm);
    covariance = geometry::inverse_of_symmetric<7>(h);
    const Vector7 step = -(covariance * g);
    if (!step.allFinite()) {
      return false;
    }
    move(step, pipe.fit);
    section.cosine_mm += step(5);
    section.sine_mm += step(6);
    const Depths7 effect = -(covariance * sums.depths) / variance;
    pipe.depth_effect = effect.topRows<5>();
    pipe.fit.covariance = covariance.topLeftCorner<5, 5>();
    gate_mm = std::clamp(kGateInRms * sums.rms_mm(), kSmallestGateMm, gate_mm);
    return true;
  }
};

}  // namespace

void settle_form(const geometry::PointSpans& points, const depth::Intrinsics& k,
                 double ovality_sigma_mm, Pipe& pipe) noexcept {
  constexpr int kIterations = 12;
  FormFit form{points, k, ovality_sigma_mm, pipe};
  form.gate_mm = std::max(kSmallestGateMm, kGateInRms * pipe.fit.rms_mm);
  for (int i = 0; i < kIterations; ++i) {
    if (!form.step()) {
      pipe.fit.state = geometry::FitState::kDegenerate;
      return;
    }
  }
  const Eigen::Vector2d oval(form.section.cosine_mm, form.section.sine_mm);
  const Eigen::Matrix2d known = form.covariance.bottomRightCorner<2, 2>();
  pipe.oval_chi_squared = oval.dot(geometry::inverse_of_symmetric<2>(known) * oval);
  pipe.ovality_mm = pipe.oval_chi_squared > kOvalChiSquaredLimit ? oval.norm() : 0.0;
}

}  // namespace dseam::splice
