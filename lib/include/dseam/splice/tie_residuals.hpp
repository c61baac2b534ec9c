// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace dseam::splice {

/// Classes of how steeply a place is seen. On a slope a patch is longer: more noise averages out in
/// it, and it has less in common with the next.
constexpr std::size_t kFacings = 4;

/// Of a surface whose normal and the ray to it have this cosine.
[[nodiscard]] std::size_t facing_of(double cosine) noexcept;

/// Residuals of ties between surface patches, and how those of neighbouring references hang
/// together: noise that is smooth on the surface does not average out tie by tie.
///
/// Units:   residuals in mm along the normal.
/// Time:    O(1) a residual; no memory but its own.
/// Source:  the long-run variance of Newey and West, Econometrica 55 (1987).
class TieResiduals {
 public:
  static constexpr std::size_t kLags = 3;

  void add(double residual) noexcept { same_.add(residual * residual); }
  /// Of references `lag` patches apart in a row, or below each other.
  void add_pair(double residual, double earlier, std::size_t lag, bool down) noexcept {
    apart_[down ? 1 : 0][lag - 1].add(residual * earlier);
  }
  void add(const TieResiduals& other) noexcept;

  /// Of one patch, where a residual is the difference of two.
  [[nodiscard]] double variance_mm2() const noexcept { return 0.5 * same_.mean(); }
  /// How many ties share one independent error: the sum of all correlations of one with the others,
  /// taken as the product of that along a row and that down a column.
  [[nodiscard]] double ties_per_independent() const noexcept;
  /// What a tie adds to the variance of a sum of many.
  [[nodiscard]] double long_run_mm2() const noexcept {
    return variance_mm2() * ties_per_independent();
  }

 private:
  struct Mean {
    double sum = 0.0;
    double count = 0.0;
    void add(double value) noexcept {
      sum += value;
      count += 1.0;
    }
    [[nodiscard]] double mean() const noexcept { return count > 0.0 ? sum / count : 0.0; }
  };

  Mean same_;
  std::array<std::array<Mean, kLags>, 2> apart_{};
};

/// Residuals of one pair of views along a line of references, the last ones kept.
class ResidualTrail {
 public:
  /// Notes a residual in `to`, with those before it. A gap in the line is a residual not known.
  void push(double residual, bool known, bool down, TieResiduals& to) noexcept;

 private:
  std::array<double, TieResiduals::kLags> last_{};
  std::array<bool, TieResiduals::kLags> known_{};
};

}  // namespace dseam::splice
