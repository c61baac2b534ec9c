// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::splice {

/// A symmetric positive definite system of up to `max_size` unknowns in lent memory, solved by
/// Cholesky. Small blocks are added with fixed-size Eigen.
///
/// Memory:  3 max_size^2 doubles.
/// Time:    solve and invert O(size^3).
class BlockSystem {
 public:
  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_size) noexcept {
    return 3 * Arena::bytes<double>(max_size * max_size) + 2 * Arena::bytes<double>(max_size);
  }
  BlockSystem() = default;
  BlockSystem(std::size_t max_size, Arena& arena) noexcept;

  /// All zero again, for `size` unknowns.
  void reset(std::size_t size) noexcept;
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

  /// Adds `block` at (row, column), and its transpose at (column, row) when that is another place.
  template <typename Derived>
  void add(std::size_t row, std::size_t column, const Eigen::MatrixBase<Derived>& block) noexcept {
    for (Eigen::Index i = 0; i < block.rows(); ++i) {
      for (Eigen::Index j = 0; j < block.cols(); ++j) {
        const auto r = row + static_cast<std::size_t>(i);
        const auto c = column + static_cast<std::size_t>(j);
        h_[r * size_ + c] += block(i, j);
        h_[c * size_ + r] += row == column ? 0.0 : block(i, j);
      }
    }
  }
  template <typename Derived>
  void add_gradient(std::size_t row, const Eigen::MatrixBase<Derived>& block) noexcept {
    for (Eigen::Index i = 0; i < block.rows(); ++i) {
      g_[row + static_cast<std::size_t>(i)] += block(i);
    }
  }
  /// What motions M x of the unknowns from `row` on feel: rows and columns become M' H and H M, and
  /// the gradient M' g.
  void project(std::size_t row, const geometry::Matrix6& m) noexcept;
  /// Six by six of the matrix.
  [[nodiscard]] geometry::Matrix6 block(std::size_t row, std::size_t column) const noexcept {
    return block_of(h_, row, column);
  }

  /// False when the matrix is not positive definite (to rounding): the step is then unset.
  [[nodiscard]] bool factorise() noexcept;
  /// The step -H^-1 g after factorise().
  void solve() noexcept;
  /// The inverse after factorise().
  void invert() noexcept;
  /// The inverse H^-1 becomes H^-1 S H^-1, where S is the matrix that was added since.
  void sandwich() noexcept;
  /// How much the squared error falls by the step: g^T H^-1 g.
  [[nodiscard]] double decrement() const noexcept;
  [[nodiscard]] std::span<const double> step() const noexcept { return step_.first(size_); }
  /// The memory of the matrix, free for other numbers between the inversion and the next reset().
  [[nodiscard]] std::span<double> spare() noexcept { return h_; }
  /// Six by six of the inverse.
  [[nodiscard]] geometry::Matrix6 inverse_block(std::size_t row,
                                                std::size_t column) const noexcept {
    return block_of(inverse_, row, column);
  }

 private:
  [[nodiscard]] double at(std::size_t row, std::size_t column) const noexcept {
    return h_[row * size_ + column];
  }
  [[nodiscard]] geometry::Matrix6 block_of(std::span<const double> matrix, std::size_t row,
                                           std::size_t column) const noexcept;
  void solve_in_place(std::span<double> x) const noexcept;

  std::size_t size_ = 0;
  std::span<double> h_;
  std::span<double> l_;
  std::span<double> inverse_;
  std::span<double> g_;
  std::span<double> step_;
};

}  // namespace dseam::splice
