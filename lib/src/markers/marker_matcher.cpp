// SPDX-License-Identifier: Apache-2.0
#include "dseam/markers/marker_matcher.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "dseam/geometry/rigid_fit.hpp"

namespace dseam::markers {
namespace {

constexpr std::uint16_t kNone = 0xFFFF;
using geometry::RigidTransform;
using Points = std::span<const Eigen::Vector3d>;

// The frame of a triangle: x along its first side, z across it.
Eigen::Matrix3d triangle_frame(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                               const Eigen::Vector3d& r, bool mirrored) noexcept {
  const Eigen::Vector3d x = (q - p).normalized();
  const Eigen::Vector3d z = x.cross(r - p).normalized() * (mirrored ? -1.0 : 1.0);
  Eigen::Matrix3d frame;
  frame << x, (mirrored ? -1.0 : 1.0) * z.cross(x), z;
  return frame;
}

bool is_thin(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
             const Eigen::Vector3d& r) noexcept {
  constexpr double kMinHeightMm = 4.0;
  return (q - p).normalized().cross(r - p).norm() < kMinHeightMm;
}

}  // namespace

// Two runs over the same hypotheses: the best, then the best that contradicts it.
struct MarkerMatcher::Search {
  const Config& config;
  Points a;
  Points b;
  const std::optional<RigidTransform>& prior;
  std::span<std::uint16_t> assigned;
  std::span<std::uint16_t> best;
  bool mirrored = false;
  bool contradicting = false;  // Count only what `best` says otherwise.
  std::uint32_t most = 0;
  std::size_t tried = 0;
  std::size_t compared = 0;

  /// The bound on time: what is left is not looked at.
  [[nodiscard]] bool cut_short() const noexcept {
    return tried >= kMaxHypotheses || compared >= kMaxCompared;
  }
  [[nodiscard]] bool near_prior(std::size_t i, std::size_t k) const noexcept {
    return !prior || (*prior * b[k] - a[i]).norm() < config.prior_gate_mm;
  }

  void restart() noexcept {
    most = 0;
    tried = 0;
    compared = 0;
  }
  void over_all() noexcept {
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t j = i + 1; j < a.size() && !cut_short(); ++j) {
        over_sides(i, j);
      }
    }
  }
  void over_sides(std::size_t i, std::size_t j) noexcept {
    constexpr double kShortestSideMm = 8.0;
    const double side = (a[i] - a[j]).norm();
    if (!(side > kShortestSideMm)) {
      return;
    }
    compared += b.size() * b.size();
    for (std::size_t k = 0; k < b.size(); ++k) {
      for (std::size_t l = 0; l < b.size(); ++l) {
        if (k != l && near_prior(i, k) && near_prior(j, l) &&
            std::abs((b[k] - b[l]).norm() - side) < config.tolerance_mm) {
          over_thirds(i, j, k, l);
        }
      }
    }
  }
  // The third marker comes after the second, so that a triangle is tried once a labelling.
  void over_thirds(std::size_t i, std::size_t j, std::size_t k, std::size_t l) noexcept {
    compared += (a.size() - j) * b.size();
    for (std::size_t m = j + 1; m < a.size() && !cut_short(); ++m) {
      const double to_i = (a[m] - a[i]).norm();
      const double to_j = (a[m] - a[j]).norm();
      for (std::size_t n = 0; n < b.size(); ++n) {
        if (n == k || n == l || std::abs((b[n] - b[k]).norm() - to_i) > config.tolerance_mm ||
            std::abs((b[n] - b[l]).norm() - to_j) > config.tolerance_mm ||
            is_thin(a[i], a[j], a[m]) || !near_prior(m, n)) {
          continue;
        }
        ++tried;
        compared += a.size() * b.size();
        try_triangle({i, j, m}, {k, l, n});
      }
    }
  }
  void try_triangle(const std::array<std::size_t, 3>& in_a,
                    const std::array<std::size_t, 3>& in_b) noexcept {
    const Eigen::Matrix3d frame_a = triangle_frame(a[in_a[0]], a[in_a[1]], a[in_a[2]], false);
    const Eigen::Matrix3d frame_b = triangle_frame(b[in_b[0]], b[in_b[1]], b[in_b[2]], mirrored);
    const Eigen::Matrix3d turn = frame_a * frame_b.transpose();
    const Eigen::Vector3d centre_a = (a[in_a[0]] + a[in_a[1]] + a[in_a[2]]) / 3.0;
    const Eigen::Vector3d centre_b = (b[in_b[0]] + b[in_b[1]] + b[in_b[2]]) / 3.0;
    const std::uint32_t count = assign({turn, centre_a - turn * centre_b});
    if (contradicting ? contradicts() && count > most : count > most) {
      most = count;
      if (!contradicting) {
        std::copy(assigned.begin(), assigned.end(), best.begin());
      }
    }
  }
  // A triangle of three near markers swings further markers out: hence twice the tolerance.
  std::uint32_t assign(const RigidTransform& T_a_b) noexcept {
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      assigned[i] = kNone;
      double nearest = 2.0 * config.tolerance_mm;
      for (std::size_t k = 0; k < b.size(); ++k) {
        const double distance = (T_a_b * b[k] - a[i]).norm();
        if (distance < nearest) {
          nearest = distance;
          assigned[i] = static_cast<std::uint16_t>(k);
        }
      }
      count += assigned[i] != kNone ? 1U : 0U;
    }
    return count;
  }
  [[nodiscard]] bool contradicts() const noexcept {
    std::uint32_t same = 0;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      count += assigned[i] != kNone ? 1U : 0U;
      same += assigned[i] != kNone && assigned[i] == best[i] ? 1U : 0U;
    }
    return 2 * same < count;
  }
};

namespace {

struct Layout {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d deviations = Eigen::Vector3d::Zero();  // Rising.
};

Layout layout_of(Points a, std::span<const std::uint16_t> chosen) noexcept {
  Layout out;
  for (const std::uint16_t i : chosen) {
    out.centre += a[i] / static_cast<double>(chosen.size());
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const std::uint16_t i : chosen) {
    scatter += (a[i] - out.centre) * (a[i] - out.centre).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  out.axes = solver.eigenvectors();
  out.deviations =
      (solver.eigenvalues().cwiseMax(0.0) / static_cast<double>(chosen.size())).cwiseSqrt();
  return out;
}

// The largest expected error of the pose at a given distance from the markers, on their axes.
double error_at(const Layout& layout, const geometry::Matrix6& covariance,
                double reach_mm) noexcept {
  double worst = 0.0;
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector3d p =
        layout.centre + layout.axes.col(k / 2) * (k % 2 == 0 ? reach_mm : -reach_mm);
    Eigen::Matrix<double, 3, 6> j;
    j << Eigen::Matrix3d::Identity(), -geometry::skew(p);
    worst = std::max(worst, (j * covariance * j.transpose()).trace());
  }
  return std::sqrt(worst);
}

}  // namespace

Result<MarkerMatcher> MarkerMatcher::make(const Config& config, std::size_t max_markers,
                                          Arena& arena) noexcept {
  if (!(config.tolerance_mm > 0.0) || config.min_pairs < 3 || max_markers < 3 ||
      max_markers >= kNone) {
    return Errc::kInvalidArgument;
  }
  MarkerMatcher matcher(config);
  matcher.assigned_ = arena.take<std::uint16_t>(max_markers);
  matcher.best_ = arena.take<std::uint16_t>(max_markers);
  matcher.pair_a_ = arena.take<std::uint16_t>(max_markers);
  matcher.pair_b_ = arena.take<std::uint16_t>(max_markers);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return matcher;
}

MatchReport MarkerMatcher::run(Points a, Points b,
                               const std::optional<RigidTransform>& prior_T_a_b) noexcept {
  num_pairs_ = 0;
  MatchReport report;
  a = a.first(std::min(a.size(), best_.size()));
  b = b.first(std::min(b.size(), best_.size()));
  Search search{config_, a, b, prior_T_a_b, assigned_.first(a.size()), best_.first(a.size())};
  std::fill(search.best.begin(), search.best.end(), kNone);
  search.mirrored = true;
  search.over_all();
  const std::uint32_t most_mirrored = search.most;
  search.mirrored = false;
  search.restart();
  std::fill(search.best.begin(), search.best.end(), kNone);
  search.over_all();
  report.num_pairs = search.most;
  if (most_mirrored >= report.num_pairs + config_.min_lead && most_mirrored > 3) {
    report.state = MatchState::kMirrored;
    return report;
  }
  if (report.num_pairs < config_.min_pairs) {
    report.state = all_on_a_line(a, b) ? MatchState::kCollinear : MatchState::kTooFew;
    return report;
  }
  report.cut_short = search.cut_short();
  search.contradicting = true;
  search.restart();
  search.over_all();
  report.num_runner_up = search.most;
  report.cut_short = report.cut_short || search.cut_short();
  refine(a, b, report);
  return report;
}

bool MarkerMatcher::all_on_a_line(Points a, Points b) const noexcept {
  const auto thin = [](Points p) {
    if (p.size() < 3) {
      return false;
    }
    std::array<std::uint16_t, 64> all{};
    const std::size_t n = std::min(p.size(), all.size());
    for (std::size_t i = 0; i < n; ++i) {
      all[i] = static_cast<std::uint16_t>(i);
    }
    return layout_of(p, std::span(all).first(n)).deviations(1) < 2.0;
  };
  return thin(a) || thin(b);
}

void MarkerMatcher::refine(Points a, Points b, MatchReport& report) noexcept {
  // Twice: the pairs that the first fit brings within the tolerance are those of the second.
  geometry::RigidFit fit;
  for (int round = 0; round < 2; ++round) {
    std::array<geometry::PointPair, kMaxFitted> pairs;
    std::size_t n = 0;
    num_pairs_ = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const std::uint16_t k = best_[i];
      if (k == kNone || n == pairs.size() ||
          (round > 0 && (fit.T_a_b * b[k] - a[i]).norm() > config_.tolerance_mm)) {
        continue;
      }
      pairs[n++] = {a[i], b[k], 1.0 / (2.0 * config_.sigma_mm * config_.sigma_mm)};
      pair_a_[num_pairs_] = static_cast<std::uint16_t>(i);
      pair_b_[num_pairs_++] = k;
    }
    fit = geometry::fit_rigid(std::span(pairs).first(n));
  }
  report.num_pairs = static_cast<std::uint32_t>(num_pairs_);
  report.T_a_b = fit.T_a_b;
  report.rms_mm = fit.rms_mm;
  const Layout layout = layout_of(a, pair_a_.first(num_pairs_));
  report.spread_mm = layout.deviations(1);
  report.error_at_reach_mm = error_at(layout, fit.covariance, config_.reach_mm);
  report.state = judge(fit.state == geometry::RigidFitState::kDetermined, report);
  num_pairs_ = report.state == MatchState::kMatched ? num_pairs_ : 0;
}

MatchState MarkerMatcher::judge(bool determined, const MatchReport& report) const noexcept {
  if (report.num_pairs < config_.min_pairs) {
    return MatchState::kTooFew;
  }
  if (!determined) {
    return MatchState::kCollinear;
  }
  if (report.cut_short || report.num_pairs < report.num_runner_up + config_.min_lead) {
    return MatchState::kSymmetric;
  }
  const bool good =
      report.spread_mm >= config_.min_spread_mm && report.error_at_reach_mm <= config_.max_error_mm;
  return good ? MatchState::kMatched : MatchState::kClustered;
}

}  // namespace dseam::markers
