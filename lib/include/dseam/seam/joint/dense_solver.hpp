// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace dseam::seam {

/// A symmetric positive definite matrix of variable order over lent memory, lower half, row by row.
///
/// Larger than a stack frame may be, which is why Eigen's fixed sizes do not serve here.
class LentSymmetric {
 public:
  LentSymmetric() = default;
  LentSymmetric(std::span<double> storage, std::size_t order) noexcept
      : storage_(storage.first(order * order)), order_(order) {}

  [[nodiscard]] double& at(std::size_t row, std::size_t col) noexcept {
    return storage_[row * order_ + col];
  }
  [[nodiscard]] double at(std::size_t row, std::size_t col) const noexcept {
    return storage_[row * order_ + col];
  }
  [[nodiscard]] std::size_t order() const noexcept { return order_; }

  /// Replaces the matrix by its Cholesky factor; false, and useless then, if it is not definite.
  [[nodiscard]] bool factorise() noexcept;
  /// x <- L^-1 x, after factorise(): |x|^2 is then the quadratic form of the inverse.
  void forward(std::span<double> x) const noexcept;
  /// x <- (L L^T)^-1 x, after factorise().
  void solve(std::span<double> x) const noexcept;

 private:
  std::span<double> storage_;
  std::size_t order_ = 0;
};

}  // namespace dseam::seam
