// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/open/along_model.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "dseam/geometry/symmetric_matrix.hpp"

namespace dseam::seam {
namespace {

constexpr double kLeastScatterMm = 1e-6;

}  // namespace

// 1, s, s^2 ... and, where it varies away from the seam, away, away * s, away^2; unused ones are 0.
AlongModel::Row AlongModel::row_at(double along, double away, const Terms& terms) noexcept {
  Row row = Row::Zero();
  double power = 1.0;
  for (int k = 0; k <= terms.order; ++k) {
    row[k] = power;
    power *= along;
  }
  if (terms.away > 0) {
    row[kMaxOrder + 1] = away;
    row[kMaxOrder + 2] = away * along;
    row[kMaxOrder + 3] = terms.away > 1 ? away * away : 0.0;
  }
  return row;
}

// The weighted sum of squares that is left.
double AlongModel::solve(std::span<const Sample> samples, const Terms& terms) noexcept {
  Square normal = Square::Zero();
  Row right = Row::Zero();
  for (const Sample& sample : samples) {
    const Row row = row_at(sample.along, sample.away, terms);
    normal += sample.weight * row * row.transpose();
    right += sample.weight * sample.value * row;
  }
  for (int i = 0; i < kColumns; ++i) {
    normal(i, i) = normal(i, i) > 0.0 ? normal(i, i) * (1.0 + 1e-10) : 1.0;
  }
  const Eigen::LDLT<Square> factor(normal);
  terms_ = terms;
  coefficients_ = factor.solve(right);
  covariance_ =
      geometry::solve_columns<Eigen::LDLT<Square>, kColumns>(factor, Square(Square::Identity()));
  double squares = 0.0;
  for (const Sample& sample : samples) {
    const double rest = sample.value - at(sample.along, sample.away);
    squares += sample.weight * rest * rest;
  }
  return squares;
}

bool AlongModel::fit(std::span<const Sample> samples, bool uses_away) noexcept {
  fitted_ = false;
  const double n = static_cast<double>(samples.size());
  Terms best{-1, 0};
  double least = 1e300;
  for (int away = uses_away ? 1 : 0; away <= (uses_away ? 2 : 0); ++away) {
    for (int order = uses_away ? 1 : 0; order <= kMaxOrder; ++order) {
      const Terms terms{order, away};
      if (n < 2.0 * terms.count() + 2.0) {
        continue;
      }
      const double squares = solve(samples, terms) + n * kLeastScatterMm * kLeastScatterMm;
      const double criterion = n * std::log(squares / n) + terms.count() * std::log(n);
      if (criterion < least) {
        least = criterion;
        best = terms;
      }
    }
  }
  if (best.order < 0) {
    coefficients_.setZero();
    covariance_.setZero();
    terms_ = {};
    return false;
  }
  const double squares = solve(samples, best);
  covariance_ *= squares / std::max(1.0, n - best.count());
  fitted_ = coefficients_.allFinite();
  return fitted_;
}

double AlongModel::at(double along, double away) const noexcept {
  return row_at(along, away, terms_).dot(coefficients_);
}

double AlongModel::variance_at(double along) const noexcept {
  const Row row = row_at(along, 0.0, {terms_.order, 0});
  double variance = 0.0;
  for (int i = 0; i < kColumns; ++i) {
    for (int k = 0; k < kColumns; ++k) {
      variance += row[i] * covariance_(i, k) * row[k];
    }
  }
  return std::max(0.0, variance);
}

}  // namespace dseam::seam
