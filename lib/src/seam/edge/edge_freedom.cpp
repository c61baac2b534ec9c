// SPDX-License-Identifier: Apache-2.0
#include "seam/edge/edge_freedom.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace dseam::seam {
namespace {

constexpr double kMaxWrongShare = 0.15;  // Noise of 0.3 mm makes a tenth of them wrong.
constexpr double kDeadShare = 0.25;      // Of an interval's width: less may be chance.

// How far from the curve the ends of its intervals lie, on one side of it.
class Ends {
 public:
  void add(double away_mm) noexcept {
    ++histogram_[std::min(static_cast<std::size_t>(away_mm / kBinMm), histogram_.size() - 1)];
    count_ += 1.0;
  }
  // Ends that lie everywhere begin at the curve, whatever share of them is looked at.
  [[nodiscard]] double nearest_mm() const noexcept {
    constexpr double kShare = 0.05;
    return std::max(0.0, 2.0 * quantile_mm(kShare) - quantile_mm(2.0 * kShare));
  }

 private:
  static constexpr double kBinMm = 0.004;

  [[nodiscard]] double quantile_mm(double share) const noexcept {
    double below = 0.0;
    std::size_t i = 0;
    while (i + 1 < histogram_.size() && below + histogram_[i] < share * count_) {
      below += histogram_[i++];
    }
    return kBinMm * (static_cast<double>(i) +
                     (share * count_ - below) / std::max<double>(1.0, histogram_[i]));
  }

  std::array<std::uint16_t, 512> histogram_{};
  double count_ = 0.0;
};

}  // namespace

EdgeFreedom freedom_of(const EdgeCurve& curve, std::span<const EdgeInterval> intervals) noexcept {
  Ends inwards;
  Ends outwards;
  double sum_mm = 0.0;
  double wrong = 0.0;
  for (const EdgeInterval& interval : intervals) {
    const double value = curve.at(interval.phi_rad);
    sum_mm += interval.high_mm - interval.low_mm;
    if (value > interval.low_mm && value < interval.high_mm) {
      inwards.add(value - interval.low_mm);
      outwards.add(interval.high_mm - value);
    } else {
      wrong += 1.0;
    }
  }
  const double count = std::max(1.0, static_cast<double>(intervals.size()));
  EdgeFreedom freedom;
  freedom.width_mm = wrong > kMaxWrongShare * count ? sum_mm / count : 0.0;
  const double dead_mm = inwards.nearest_mm() + outwards.nearest_mm();
  if (dead_mm > kDeadShare * sum_mm / count) {
    freedom.width_mm = std::max(freedom.width_mm, dead_mm);
    freedom.to_middle_mm = 0.5 * (outwards.nearest_mm() - inwards.nearest_mm());
  }
  return freedom;
}

}  // namespace dseam::seam
