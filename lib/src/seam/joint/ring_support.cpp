// SPDX-License-Identifier: Apache-2.0
#include "seam/joint/ring_support.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dseam::seam {
namespace {

constexpr double kTurnRad = 2.0 * std::numbers::pi;
constexpr double kSupportRad = 0.61;  // 35 degrees: cells at a joint have blurred normals.
constexpr double kOtherSideCosine = -0.1;
constexpr double kMaxAside = 4.0;  // Bins.

void count_around(int middle, int bins_aside, RingSupport::Counts& counts) noexcept {
  for (int i = middle - bins_aside; i <= middle + bins_aside; ++i) {
    ++counts[static_cast<std::size_t>((i + RingFinder::kBins) % RingFinder::kBins)];
  }
}

int bin_of(double phi_rad) noexcept {
  const double turn = phi_rad / kTurnRad;
  const int bin = static_cast<int>((turn - std::floor(turn)) * RingFinder::kBins);
  return std::clamp(bin, 0, RingFinder::kBins - 1);
}

// A cell without a normal holds a bit of both surfaces: at a joint that speaks for it.
bool lies_along(const Eigen::Vector3d& normal, const Cell& cell, double cosine) noexcept {
  return cell.normal.squaredNorm() == 0.0 || std::abs(normal.dot(cell.normal)) > cosine;
}

}  // namespace

RingSupport support_of(std::span<const Cell> cells, const Joint& joint, const NozzleFrame& frame,
                       const CellScale& scale, double half_cell_mm) noexcept {
  RingSupport s;
  const double bin_mm = kTurnRad * joint.nozzle.radius_mm / double{RingFinder::kBins};
  const int bins_aside = static_cast<int>(std::min(half_cell_mm / bin_mm + 0.5, kMaxAside));
  const double band = std::max(5.0 * scale.cell_mm, 15.0);
  const double tolerance_mm = scale.tolerance_mm();
  const double cosine = std::cos(kSupportRad + scale.slack_rad());
  for (const Cell& cell : cells) {
    if (shell_normal(joint, cell.mean).dot(joint.nozzle.axis) < kOtherSideCosine) {
      continue;  // Where the nozzle's axis leaves the shell on its other side.
    }
    const double above = shell_distance(joint, cell.mean);
    const double outside = signed_distance(joint.nozzle, cell.mean);
    const int middle = bin_of(angle_about(joint.nozzle, frame, cell.mean));
    const bool on_shell =
        std::abs(above) < tolerance_mm && outside > tolerance_mm && outside < band;
    const bool on_nozzle = std::abs(outside) < tolerance_mm && std::abs(above) > tolerance_mm &&
                           std::abs(above) < band;
    if (on_shell && lies_along(outward_normal(joint.shell, cell.mean), cell, cosine)) {
      count_around(middle, bins_aside, s.shell_outside);
    } else if (on_nozzle && lies_along(outward_normal(joint.nozzle, cell.mean), cell, cosine)) {
      count_around(middle, bins_aside, above > 0.0 ? s.nozzle_above : s.nozzle_below);
    }
  }
  return s;
}

}  // namespace dseam::seam
