// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace dseam::seam {

/// Between two measurements, of which one is on the shell and the other is past its edge: the
/// edge's distance from the nozzle lies between the two numbers.
struct EdgeInterval {
  double phi_rad = 0.0;
  double low_mm = 0.0;   ///< Past the edge: something was seen behind the shell here.
  double high_mm = 0.0;  ///< Still on the shell.
};

/// The shell's edge at a gap: its distance from the nozzle as a periodic function of the angle.
///
/// Each end of an interval is a vote, past the edge or on the shell, and the curve is where the
/// votes change. Every interval is true, however wide a pixel's footprint or a dropped pixel made
/// it; so there is no half-pixel bias to correct, and many wide intervals leave a narrow way. A
/// share of wrong intervals is part of the model. The order is chosen by the Bayesian information
/// criterion.
///
/// Source:  logistic regression with a share of wrong labels.
class EdgeCurve {
 public:
  static constexpr std::size_t kMaxHarmonics = 6;
  static constexpr std::size_t kSectors = 36;
  static constexpr std::size_t kMaxOrder = 2 * kMaxHarmonics + 1;
  using Vector = std::array<double, kMaxOrder>;

  /// False when the intervals are too few, or leave a quarter of the turn without one.
  ///
  /// `smear_mm` is the length over which the scanner smears the edge: all intervals then err alike.
  bool fit(std::span<const EdgeInterval> intervals, double smear_mm = 0.0) noexcept;

  [[nodiscard]] double at(double phi_rad) const noexcept;
  /// Of at(): what the votes disagree about, and how far the intervals leave the curve free, which
  /// then runs in the middle of what they leave.
  [[nodiscard]] double variance_at(double phi_rad) const noexcept;
  /// Of a harmonic that the criterion may have left out though it is there: of its pair of
  /// coefficients, as likely to be anything that would not have been taken in.
  [[nodiscard]] double unnoticed_variance_at(double phi_rad) const noexcept {
    return log_count_ * variance_at(phi_rad) / static_cast<double>(order_);
  }
  /// Whether an interval lies within about ten degrees.
  [[nodiscard]] bool held_at(double phi_rad) const noexcept;
  [[nodiscard]] std::size_t harmonics() const noexcept { return (order_ - 1) / 2; }
  /// Of the periodic functions, how many are in use; they are 1, cos, sin, cos 2 phi, ...
  [[nodiscard]] std::size_t order() const noexcept { return order_; }
  [[nodiscard]] static Vector basis_at(double phi_rad) noexcept;

 private:
  using Storage = std::array<double, kMaxOrder * kMaxOrder>;
  struct Fit {
    double log_likelihood = -1e300;
    double blur_mm = 1.0;
    std::size_t order = 1;
    Vector coefficients{};
  };

  [[nodiscard]] double value_at(const Vector& basis) const noexcept;
  [[nodiscard]] bool stays_among(std::span<const EdgeInterval> intervals) const noexcept;
  double improve(std::span<const EdgeInterval> intervals) noexcept;
  Fit solve(std::span<const EdgeInterval> intervals, const Vector& start,
            std::size_t order) noexcept;
  void estimate_slack(std::span<const EdgeInterval> intervals) noexcept;
  void estimate_covariance(std::span<const EdgeInterval> intervals) noexcept;

  std::size_t order_ = 1;
  double blur_mm_ = 1.0;
  double smear_mm_ = 0.0;
  double free_mm_ = 0.0;    // Width of the band in which the intervals leave the curve free.
  double log_count_ = 0.0;  // Of the intervals that err by themselves.
  std::array<double, kSectors> slack_mm_{};
  Vector coefficients_{};
  Storage normal_{};  // Its Cholesky factor after improve().
  Storage meat_{};
};

/// Where the surfaces were seen to end beside each other; nullptr where they go on.
struct JointEdges {
  const EdgeCurve* shell = nullptr;   ///< Its distance from the nozzle: the gap.
  const EdgeCurve* nozzle = nullptr;  ///< Its height above the shell: the mismatch.
};

}  // namespace dseam::seam
