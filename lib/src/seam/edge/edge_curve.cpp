// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/edge/edge_curve.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dseam/seam/joint/dense_solver.hpp"

namespace dseam::seam {
namespace {

constexpr std::size_t kMinIntervals = 40;
constexpr std::size_t kSectors = 36;
constexpr std::size_t kMinSectors = 12;
constexpr double kPull = 1e-3;      // Towards the middle of an interval that is kept already.
constexpr double kFloorMm = 0.004;  // Below this a violation tells nothing.
constexpr int kRounds = 14;
constexpr double kFirstCutMm = 4.0;
constexpr double kLastCutMm = 0.15;

EdgeCurve::Vector basis_at(double phi_rad) noexcept {
  const double c1 = std::cos(phi_rad);
  const double s1 = std::sin(phi_rad);
  EdgeCurve::Vector b;
  double c = 1.0;
  double s = 0.0;
  b[0] = 1.0;
  for (std::size_t k = 1; k < b.size(); k += 2) {
    const double next = c * c1 - s * s1;
    s = s * c1 + c * s1;
    c = next;
    b[k] = c;
    b[k + 1] = s;
  }
  return b;
}

std::size_t sector_of(double phi_rad) noexcept {
  const double turn = phi_rad / (2.0 * std::numbers::pi);
  const double place = (turn - std::floor(turn)) * double{kSectors};
  return std::min(static_cast<std::size_t>(std::max(0.0, place)), kSectors - 1);
}

bool all_round(std::span<const EdgeInterval> intervals) noexcept {
  std::array<bool, kSectors> seen{};
  for (const EdgeInterval& interval : intervals) {
    seen[sector_of(interval.phi_rad)] = true;
  }
  return static_cast<std::size_t>(std::count(seen.begin(), seen.end(), true)) >= kMinSectors;
}

// What is missing to bring `value` into the interval.
double missing_of(const EdgeInterval& interval, double value) noexcept {
  return value < interval.low_mm ? interval.low_mm - value
                                 : std::min(0.0, interval.high_mm - value);
}

// A violation beyond the cut is a wrong interval: spatter, or a clamp's shadow.
double trust(double missing_mm, double cut_mm) noexcept {
  const double inside = 1.0 - missing_mm * missing_mm / (cut_mm * cut_mm);
  return inside > 0.0 ? inside * inside : 0.0;
}

}  // namespace

double EdgeCurve::value_at(const Vector& basis) const noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < order_; ++i) {
    sum += basis[i] * coefficients_[i];
  }
  return sum;
}

// One step of reweighted least squares; the mean squared violation before it.
double EdgeCurve::improve(std::span<const EdgeInterval> intervals, double cut_mm,
                          bool first) noexcept {
  LentSymmetric normal(normal_, order_);
  std::fill(normal_.begin(), normal_.end(), 0.0);
  Vector right{};
  double squares = 0.0;
  for (const EdgeInterval& interval : intervals) {
    const Vector b = basis_at(interval.phi_rad);
    const double value = value_at(b);
    const double missing = missing_of(interval, value);
    const double middle = 0.5 * (interval.low_mm + interval.high_mm) - value;
    const bool kept = first || missing == 0.0;
    const double weight = first ? 1.0 : (kept ? kPull : trust(missing, cut_mm));
    for (std::size_t i = 0; i < order_; ++i) {
      right[i] += weight * (kept ? middle : missing) * b[i];
      for (std::size_t k = 0; k <= i; ++k) {
        normal.at(i, k) += weight * b[i] * b[k];
      }
    }
    squares += std::min(missing * missing, cut_mm * cut_mm);
  }
  for (std::size_t i = 0; i < order_; ++i) {
    normal.at(i, i) += 1e-9;
  }
  if (normal.factorise()) {
    normal.solve(std::span<double>(right).first(order_));
    for (std::size_t i = 0; i < order_; ++i) {
      coefficients_[i] += right[i];
    }
  }
  return squares / static_cast<double>(intervals.size());
}

double EdgeCurve::solve(std::span<const EdgeInterval> intervals, std::size_t order) noexcept {
  order_ = order;
  coefficients_ = {};
  double cut = kFirstCutMm;  // Wide at first: the first curve may be anywhere.
  double mean_square = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    mean_square = improve(intervals, cut, round == 0);
    cut = std::max(kLastCutMm, 0.6 * cut);
  }
  return mean_square;
}

bool EdgeCurve::fit(std::span<const EdgeInterval> intervals) noexcept {
  constexpr std::array<std::size_t, 5> kOrders = {1, 3, 5, 9, 13};
  if (intervals.size() < kMinIntervals || !all_round(intervals)) {
    return false;
  }
  const double n = static_cast<double>(intervals.size());
  double best = 1e300;
  std::size_t best_order = 1;
  for (const std::size_t order : kOrders) {
    const double mean_square = solve(intervals, order);
    const double criterion = n * std::log(mean_square + kFloorMm * kFloorMm) +
                             2.0 * static_cast<double>(order) * std::log(n);
    if (criterion < best) {
      best = criterion;
      best_order = order;
    }
  }
  scatter_mm_ = std::sqrt(solve(intervals, best_order));
  estimate_covariance(intervals);
  return std::all_of(coefficients_.begin(), coefficients_.end(),
                     [](double c) { return std::isfinite(c); });
}

// The filling of a sandwich: what one sector's intervals pull together counts once.
void EdgeCurve::estimate_covariance(std::span<const EdgeInterval> intervals) noexcept {
  meat_ = {};
  for (std::size_t sector = 0; sector < kSectors; ++sector) {
    Vector pull{};
    for (const EdgeInterval& interval : intervals) {
      if (sector_of(interval.phi_rad) != sector) {
        continue;
      }
      const Vector b = basis_at(interval.phi_rad);
      const double missing = missing_of(interval, value_at(b));
      const double weight = missing == 0.0 ? kPull : trust(missing, kLastCutMm);
      for (std::size_t i = 0; i < order_; ++i) {
        pull[i] += weight * missing * b[i];
      }
    }
    for (std::size_t i = 0; i < order_; ++i) {
      for (std::size_t k = 0; k < order_; ++k) {
        meat_[i * order_ + k] += pull[i] * pull[k];
      }
    }
  }
}

double EdgeCurve::at(double phi_rad) const noexcept { return value_at(basis_at(phi_rad)); }

double EdgeCurve::variance_at(double phi_rad) const noexcept {
  Storage factor = normal_;
  Vector b = basis_at(phi_rad);
  LentSymmetric(factor, order_).solve(std::span<double>(b).first(order_));
  double sum = 0.0;
  for (std::size_t i = 0; i < order_; ++i) {
    for (std::size_t k = 0; k < order_; ++k) {
      sum += b[i] * meat_[i * order_ + k] * b[k];
    }
  }
  return sum;
}

}  // namespace dseam::seam
