// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/edge/edge_curve.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dseam/seam/joint/dense_solver.hpp"
#include "seam/edge/edge_freedom.hpp"

namespace dseam::seam {
namespace {

constexpr std::size_t kMinIntervals = 40;
constexpr std::size_t kSectors = EdgeCurve::kSectors;
constexpr std::size_t kMaxUnseen = 9;  // Sectors in a row: a quarter of the turn.
constexpr double kUnheld =
    -1.0;  // Slack of a sector in which nothing was seen: free by 1 mm, and marked.
constexpr double kMaxSlackMm = 8.0;
constexpr double kWrongShare = 0.01;  // Of the intervals: flying pixels, spatter, a clamp's shadow.
constexpr double kFirstBlurMm = 0.3;  // Wide at first: the first curve may be anywhere.
constexpr double kShrink = 0.5;
constexpr double kLeastBlurMm = 0.004;
constexpr int kRounds = 3;  // Newton steps at one blur.
constexpr double kKinship =
    2.0;  // Lines of pixels next to each other err alike: so many count once.
constexpr double kMaxStepMm = 1.0;

std::size_t sector_of(double phi_rad) noexcept {
  const double turn = phi_rad / (2.0 * std::numbers::pi);
  const double place = (turn - std::floor(turn)) * double{kSectors};
  return std::min(static_cast<std::size_t>(std::max(0.0, place)), kSectors - 1);
}

// The longest run of sectors, round the turn, in which nothing was seen.
std::size_t longest_gap(const std::array<double, EdgeCurve::kSectors>& slack_mm) noexcept {
  std::size_t longest = 0;
  std::size_t run = 0;
  for (std::size_t i = 0; i < 2 * slack_mm.size(); ++i) {
    run = slack_mm[i % slack_mm.size()] == kUnheld ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return std::min(longest, slack_mm.size());
}

double logistic(double x) noexcept { return 1.0 / (1.0 + std::exp(-x)); }

// What one interval says to an edge at `value`.
struct Vote {
  double log_likelihood;
  double pull;  // Its slope with the value.
  double bend;  // Its curvature, positive; what a wrong interval is suspected of is left out.
};

Vote vote_of(const EdgeInterval& interval, double value, double blur_mm) noexcept {
  const double above_low = logistic((value - interval.low_mm) / blur_mm);
  const double below_high = logistic((interval.high_mm - value) / blur_mm);
  const double width = (interval.high_mm - interval.low_mm) / blur_mm;
  const double right = above_low * below_high * -std::expm1(-width);
  const double likelihood = right + kWrongShare;
  const double trust = right / likelihood;
  return {std::log(likelihood), trust * (below_high - above_low) / blur_mm,
          trust * (above_low * (1.0 - above_low) + below_high * (1.0 - below_high)) /
              (blur_mm * blur_mm)};
}

}  // namespace

EdgeCurve::Vector EdgeCurve::basis_at(double phi_rad) noexcept {
  const double c1 = std::cos(phi_rad);
  const double s1 = std::sin(phi_rad);
  Vector b;
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

double EdgeCurve::value_at(const Vector& basis) const noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < order_; ++i) {
    sum += basis[i] * coefficients_[i];
  }
  return sum;
}

// One Newton step; the likelihood before it.
double EdgeCurve::improve(std::span<const EdgeInterval> intervals) noexcept {
  LentSymmetric normal(normal_, order_);
  std::fill(normal_.begin(), normal_.end(), 0.0);
  Vector right{};
  double log_likelihood = 0.0;
  for (const EdgeInterval& interval : intervals) {
    const Vector b = basis_at(interval.phi_rad);
    const Vote vote = vote_of(interval, value_at(b), blur_mm_);
    log_likelihood += vote.log_likelihood;
    for (std::size_t i = 0; i < order_; ++i) {
      right[i] += vote.pull * b[i];
      for (std::size_t k = 0; k <= i; ++k) {
        normal.at(i, k) += vote.bend * b[i] * b[k];
      }
    }
  }
  for (std::size_t i = 0; i < order_; ++i) {
    normal.at(i, i) = normal.at(i, i) * (1.0 + 1e-6) + 1e-6;
  }
  if (normal.factorise()) {
    normal.solve(std::span<double>(right).first(order_));
    for (std::size_t i = 0; i < order_; ++i) {
      coefficients_[i] += std::clamp(right[i], -kMaxStepMm, kMaxStepMm);
    }
  }
  return log_likelihood;
}

// From a wide blur to the one that the intervals themselves speak for.
EdgeCurve::Fit EdgeCurve::solve(std::span<const EdgeInterval> intervals, const Vector& start,
                                std::size_t order) noexcept {
  order_ = order;
  coefficients_ = start;
  Fit best;
  for (double blur = kFirstBlurMm; blur >= kLeastBlurMm; blur *= kShrink) {
    blur_mm_ = blur;
    double log_likelihood = 0.0;
    for (int round = 0; round < kRounds; ++round) {
      log_likelihood = improve(intervals);
    }
    if (log_likelihood < best.log_likelihood) {
      break;
    }
    best = {log_likelihood, blur, order, coefficients_};
  }
  coefficients_ = best.coefficients;
  return best;
}

// No farther out or in than any interval, at every angle: a curve is free to swing where it is not
// held.
bool EdgeCurve::stays_among(std::span<const EdgeInterval> intervals) const noexcept {
  const auto [lowest, highest] = std::minmax_element(
      intervals.begin(), intervals.end(), [](const EdgeInterval& a, const EdgeInterval& b) {
        return a.low_mm + a.high_mm < b.low_mm + b.high_mm;
      });
  for (std::size_t i = 0; i < 2 * kSectors; ++i) {
    const double value = at(std::numbers::pi * static_cast<double>(i) / double{kSectors});
    if (!(value > lowest->low_mm && value < highest->high_mm)) {
      return false;
    }
  }
  return true;
}

bool EdgeCurve::fit(std::span<const EdgeInterval> intervals, double smear_mm) noexcept {
  constexpr std::array<std::size_t, 6> kOrders = {1, 3, 5, 7, 9, 13};
  smear_mm_ = smear_mm;
  estimate_slack(intervals);
  const std::size_t unseen = longest_gap(slack_mm_);
  if (intervals.size() < kMinIntervals || unseen > kMaxUnseen) {
    return false;
  }
  Vector start{};
  for (const EdgeInterval& interval : intervals) {
    start[0] += 0.5 * (interval.low_mm + interval.high_mm) / static_cast<double>(intervals.size());
  }
  log_count_ = std::log(static_cast<double>(intervals.size()) / kKinship);
  double least = 1e300;
  Fit best;
  for (const std::size_t order : kOrders) {
    if (order > 1 && (order - 1) * unseen > kSectors) {
      break;  // Half a wave in what was not seen is free to be anything.
    }
    const Fit found = solve(intervals, start, order);
    const double criterion =
        -2.0 * found.log_likelihood / kKinship + static_cast<double>(order) * log_count_;
    if (criterion < least && stays_among(intervals)) {
      least = criterion;
      best = found;
    }
  }
  if (least == 1e300) {
    return false;
  }
  order_ = best.order;
  blur_mm_ = best.blur_mm;
  coefficients_ = best.coefficients;
  (void)improve(intervals);
  const EdgeFreedom freedom = freedom_of(*this, intervals);
  free_mm_ = freedom.width_mm;
  coefficients_[0] += freedom.to_middle_mm;
  estimate_covariance(intervals);
  estimate_slack(intervals);
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
      const double strength = vote_of(interval, value_at(b), blur_mm_).pull;
      for (std::size_t i = 0; i < order_; ++i) {
        pull[i] += strength * b[i];
      }
    }
    // As many degrees of freedom as the fit took are missing in the pulls.
    const double scale = double{kSectors} / static_cast<double>(kSectors - order_);
    for (std::size_t i = 0; i < order_; ++i) {
      for (std::size_t k = 0; k < order_; ++k) {
        meat_[i * order_ + k] += scale * pull[i] * pull[k];
      }
    }
  }
}

// How far the curve may go in each sector before an interval that it keeps is left: of wide
// intervals it may be anywhere inside, and their votes say nothing of that.
void EdgeCurve::estimate_slack(std::span<const EdgeInterval> intervals) noexcept {
  std::array<double, kSectors> up;
  std::array<double, kSectors> down;
  up.fill(0.5 * kMaxSlackMm);
  down.fill(0.5 * kMaxSlackMm);
  slack_mm_.fill(kUnheld);
  for (const EdgeInterval& interval : intervals) {
    const std::size_t i = sector_of(interval.phi_rad);
    const double value = at(interval.phi_rad);
    up[i] = value < interval.high_mm ? std::min(up[i], interval.high_mm - value) : up[i];
    down[i] = value > interval.low_mm ? std::min(down[i], value - interval.low_mm) : down[i];
    slack_mm_[i] = up[i] + down[i];
  }
}

bool EdgeCurve::held_at(double phi_rad) const noexcept {
  const std::size_t i = sector_of(phi_rad);
  return slack_mm_[(i + kSectors - 1) % kSectors] != kUnheld || slack_mm_[i] != kUnheld ||
         slack_mm_[(i + 1) % kSectors] != kUnheld;
}

double EdgeCurve::at(double phi_rad) const noexcept { return value_at(basis_at(phi_rad)); }

double EdgeCurve::variance_at(double phi_rad) const noexcept {
  Storage factor = normal_;
  const Vector b = basis_at(phi_rad);
  Vector x = b;
  LentSymmetric(factor, order_).solve(std::span<double>(x).first(order_));
  double scatter = 0.0;
  double freedom = 0.0;
  for (std::size_t i = 0; i < order_; ++i) {
    freedom += kKinship * b[i] * x[i];
    for (std::size_t k = 0; k < order_; ++k) {
      scatter += x[i] * meat_[i * order_ + k] * x[k];
    }
  }
  // Where hardly a vote holds the curve it is free, but not beyond the intervals.
  const double slack = slack_mm_[sector_of(phi_rad)];
  const double least = slack == kUnheld ? slack * slack / 12.0 : 0.0;
  return scatter + smear_mm_ * smear_mm_ / 12.0 +
         std::max({least, std::min(freedom, slack * slack / 12.0), free_mm_ * free_mm_ / 12.0});
}

}  // namespace dseam::seam
