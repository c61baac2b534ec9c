// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "dseam/hal/sim/scanner.hpp"

namespace dseam::hal::sim {

/// Whether a point lies where the scanner is blind: a grid over the joint answers without a search.
class BlindZone {
 public:
  explicit BlindZone(const Blind& blind);
  [[nodiscard]] bool covers(const Eigen::Vector3d& p) const noexcept;

 private:
  static constexpr double kCellMm = 4.0;

  [[nodiscard]] Eigen::Array3i cell_of(const Eigen::Vector3d& p) const noexcept;
  [[nodiscard]] std::size_t index_of(const Eigen::Array3i& cell) const noexcept;
  void fill_cells();
  [[nodiscard]] bool is_unseen(double s_mm) const noexcept;
  /// Squared distance to the curve between sample `i` and the next, where there is a next.
  [[nodiscard]] double squared_distance(const Eigen::Vector3d& p, std::size_t i) const noexcept;

  const Blind& blind_;
  double reach_mm_ = 0.0;
  Eigen::Vector3d corner_ = Eigen::Vector3d::Zero();
  Eigen::Array3i size_ = Eigen::Array3i::Zero();
  std::vector<std::vector<std::uint32_t>> cells_;  ///< Curve samples within reach of each cell.
};

}  // namespace dseam::hal::sim
