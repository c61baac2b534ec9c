// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/cloud/cloud.hpp"

namespace dseam::seam {

/// The points of one cube of space, reduced to a piece of surface.
struct Cell {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< Of the cell and its neighbours; any sign.
  std::uint32_t count = 0;
  cloud::ViewMask seen_by = 0;
};

/// How well the cells of a cloud can be told apart.
struct CellScale {
  double cell_mm = 0.0;
  /// Of a cell's mean about the plane of those around it: what noise has in common over a cell,
  /// and what the views disagree about.
  double scatter_mm = 0.0;

  /// How far a cell may lie off its surface, the surface's own deviations included.
  [[nodiscard]] double tolerance_mm() const noexcept;
  /// How much more the normal of a cell may be off than that of an exact one.
  [[nodiscard]] double slack_rad() const noexcept;
};

/// Cuts a cloud into cubes whose size follows the cloud's own spacing and noise, and finds the
/// normal of each. Everything coarse works on these few thousand pieces instead of on points.
///
/// Shape:   cells in the order in which their first point came.
/// Memory:  `bytes()` from the arena.
/// Time:    O(points) for each of at most five passes.
/// Source:  plane of least squares through a cell and its 26 neighbours.
class CellMap {
 public:
  struct Report {
    std::uint32_t num_points = 0;
    std::uint32_t num_not_finite = 0;  ///< Or further than 2^20 cells from the first point.
    bool full = false;                 ///< Even the coarsest cells were too many.
    CellScale scale;
    double spacing_mm = 0.0;
    double noise_mm = 0.0;  ///< Median scatter of points about their own cell's plane.
    double extent_mm = 0.0;
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_cells) noexcept;
  CellMap() = default;
  CellMap(std::size_t max_cells, Arena& arena) noexcept;

  Report run(const cloud::FusedCloudView& in) noexcept;
  [[nodiscard]] std::span<const Cell> cells() const noexcept { return cells_.view(); }

 private:
  struct Key {
    std::int32_t x, y, z;
    friend bool operator==(const Key&, const Key&) = default;
  };
  // Sums about the pivot, so that those of neighbours simply add.
  struct Moments {
    double n = 0.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  };

  void fill(const cloud::FusedCloudView& in, Report& report) noexcept;
  bool add(const Key& key, const Eigen::Vector3d& p, cloud::ViewMask seen_by) noexcept;
  std::uint32_t find_slot(const Key& key) const noexcept;
  void estimate_scales(Report& report) noexcept;
  void estimate_normals(Report& report) noexcept;
  [[nodiscard]] Moments around_cell(std::size_t i, const Eigen::Vector3d& normal,
                                    double off_limit_mm) const noexcept;

  Eigen::Vector3d pivot_ = Eigen::Vector3d::Zero();
  Buffer<Cell> cells_;
  std::span<Key> keys_;
  std::span<Moments> moments_;
  std::span<std::uint32_t> slots_;  // Cell index + 1; 0 is free.
  std::span<double> scratch_;
};

constexpr std::size_t CellMap::bytes(std::size_t max_cells) noexcept {
  return Arena::bytes<Cell>(max_cells) + Arena::bytes<Key>(max_cells) +
         Arena::bytes<Moments>(max_cells) + Arena::bytes<std::uint32_t>(4 * max_cells) +
         Arena::bytes<double>(max_cells);
}

}  // namespace dseam::seam
