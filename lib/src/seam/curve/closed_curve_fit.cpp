// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/curve/closed_curve_fit.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dseam/seam/joint/dense_solver.hpp"

namespace dseam::seam {
namespace {

constexpr std::size_t kMinPoints = 30;
constexpr int kRounds = 20;
constexpr int kOutlierRounds = 3;
constexpr double kOutlierSigmas = 8.0;
constexpr double kMaxStepRad = 0.05;
constexpr double kMaxHoleRad = std::numbers::pi / 2.0;

std::array<double, ClosedCurveFit::kCoefficients> basis_at(double t) noexcept {
  std::array<double, ClosedCurveFit::kCoefficients> b;
  b[0] = 1.0;
  for (std::size_t k = 1; k <= ClosedCurveFit::kHarmonics; ++k) {
    b[2 * k - 1] = std::cos(static_cast<double>(k) * t);
    b[2 * k] = std::sin(static_cast<double>(k) * t);
  }
  return b;
}

}  // namespace

ClosedCurveFit::Report ClosedCurveFit::run(std::span<const Eigen::Vector3d> points,
                                           double point_spacing_mm,
                                           Buffer<SeamPoint>& out) noexcept {
  Report report;
  out.clear();
  if (!lay_out(points, report)) {
    return report;
  }
  for (int outlier_round = 0; outlier_round < kOutlierRounds; ++outlier_round) {
    for (int round = 0; round < kRounds; ++round) {
      if (!fit_series()) {
        report.refusal = Refusal::kNoRing;
        return report;
      }
      move_to_feet();
    }
    reject_outliers(report);
  }
  report.refusal = Refusal::kNoRing;
  if (!fit_surfaces(report)) {
    return report;
  }
  find_hole(report);
  if (report.largest_hole_rad > kMaxHoleRad) {
    report.refusal = Refusal::kLargeHole;
    return report;
  }
  describe(report);
  write_curve(point_spacing_mm, report, out);
  return report;
}

// A first parameter: the angle in the plane of least squares.
bool ClosedCurveFit::lay_out(std::span<const Eigen::Vector3d> points, Report& report) noexcept {
  count_ = 0;
  centre_.setZero();
  for (const Eigen::Vector3d& p : points) {
    if (p.allFinite() && p.cwiseAbs().maxCoeff() < 1e7 && count_ < stations_.size()) {
      stations_[count_++] = {p, 0.0, 0.0, true};
      centre_ += p;
    }
  }
  report.num_points = static_cast<std::uint32_t>(count_);
  if (count_ < kMinPoints) {
    return false;
  }
  centre_ /= static_cast<double>(count_);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Station& s : stations_.first(count_)) {
    spread += (s.p - centre_) * (s.p - centre_).transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(spread / static_cast<double>(count_));
  report.refusal = solver.eigenvalues()[2] < 1.0 ? Refusal::kNotMillimetres : Refusal::kNoRing;
  if (!(solver.eigenvalues()[1] > 0.01 * solver.eigenvalues()[2]) ||
      report.refusal == Refusal::kNotMillimetres) {
    return false;  // A line, a point, or metres.
  }
  up_ = solver.eigenvectors().col(0);
  const AcrossAxis frame = across(up_);
  for (Station& s : stations_.first(count_)) {
    s.t_rad = std::atan2((s.p - centre_).dot(frame.v), (s.p - centre_).dot(frame.u));
  }
  return true;
}

bool ClosedCurveFit::fit_series() noexcept {
  Work& work = work_[0];
  LentSymmetric normal(work.normal, kCoefficients);
  work.normal = {};
  work.series = {};
  for (const Station& s : stations_.first(count_)) {
    if (!s.used) {
      continue;
    }
    const Basis b = basis_at(s.t_rad);
    for (std::size_t i = 0; i < kCoefficients; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        work.series[static_cast<std::size_t>(axis)][i] += b[i] * (s.p - centre_)[axis];
      }
      for (std::size_t k = 0; k <= i; ++k) {
        normal.at(i, k) += b[i] * b[k];
      }
    }
  }
  for (std::size_t i = 0; i < kCoefficients; ++i) {
    normal.at(i, i) *= 1.0 + 1e-9;
  }
  if (!normal.factorise()) {
    return false;
  }
  for (Basis& series : work.series) {
    normal.solve(series);
  }
  return true;
}

ClosedCurveFit::Jet ClosedCurveFit::at(double t_rad) const noexcept {
  const Basis b = basis_at(t_rad);
  Jet jet{centre_, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    const Basis& c = work_[0].series[static_cast<std::size_t>(axis)];
    jet.p[axis] += c[0];
    for (std::size_t k = 1; k <= kHarmonics; ++k) {
      const double f = static_cast<double>(k);
      const double even = c[2 * k - 1] * b[2 * k - 1] + c[2 * k] * b[2 * k];
      jet.p[axis] += even;
      jet.d1[axis] += f * (c[2 * k] * b[2 * k - 1] - c[2 * k - 1] * b[2 * k]);
      jet.d2[axis] -= f * f * even;
    }
  }
  return jet;
}

void ClosedCurveFit::move_to_feet() noexcept {
  for (Station& s : stations_.first(count_)) {
    const Jet jet = at(s.t_rad);
    const Eigen::Vector3d off = jet.p - s.p;
    const double bend = jet.d1.squaredNorm() + off.dot(jet.d2);
    const double slope = jet.d1.squaredNorm();
    const double step = off.dot(jet.d1) / std::max(bend, 0.3 * slope + 1e-12);
    s.t_rad -= std::clamp(step, -kMaxStepRad, kMaxStepRad);
    s.off_mm = (at(s.t_rad).p - s.p).norm();
  }
}

void ClosedCurveFit::reject_outliers(Report& report) noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    sorted_[i] = stations_[i].off_mm;
  }
  const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(count_ / 2);
  std::nth_element(sorted_.begin(), middle, sorted_.begin() + static_cast<std::ptrdiff_t>(count_));
  const double cut = kOutlierSigmas * 1.4826 * *middle + 1e-6;
  report.num_outliers = 0;
  for (Station& s : stations_.first(count_)) {
    s.used = s.off_mm < cut;
    report.num_outliers += s.used ? 0 : 1;
  }
}

}  // namespace dseam::seam
