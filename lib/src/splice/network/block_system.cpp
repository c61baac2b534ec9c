// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/block_system.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dseam::splice {

BlockSystem::BlockSystem(std::size_t max_size, Arena& arena) noexcept
    : h_(arena.take<double>(max_size * max_size)),
      l_(arena.take<double>(max_size * max_size)),
      inverse_(arena.take<double>(max_size * max_size)),
      g_(arena.take<double>(max_size)),
      step_(arena.take<double>(max_size)) {}

void BlockSystem::reset(std::size_t size) noexcept {
  DSEAM_EXPECTS(size <= g_.size());
  size_ = size;
  std::fill_n(h_.begin(), size * size, 0.0);
  std::fill_n(g_.begin(), size, 0.0);
}

void BlockSystem::project(std::size_t row, const geometry::Matrix6& m) noexcept {
  using Columns = Eigen::Map<geometry::Vector6, 0, Eigen::InnerStride<>>;
  for (std::size_t k = 0; k < size_; ++k) {
    Columns column(h_.data() + row * size_ + k,
                   Eigen::InnerStride<>(static_cast<Eigen::Index>(size_)));
    column = geometry::Vector6(m.transpose() * column);
  }
  for (std::size_t k = 0; k < size_; ++k) {
    Eigen::Map<geometry::Vector6> part(h_.data() + k * size_ + row);
    part = geometry::Vector6(m.transpose() * part);
  }
  Eigen::Map<geometry::Vector6> gradient(g_.data() + row);
  gradient = geometry::Vector6(m.transpose() * gradient);
}

geometry::Matrix6 BlockSystem::block_of(std::span<const double> matrix, std::size_t row,
                                        std::size_t column) const noexcept {
  using Rows =
      Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>, 0, Eigen::OuterStride<>>;
  return Rows(matrix.data() + row * size_ + column,
              Eigen::OuterStride<>(static_cast<Eigen::Index>(size_)));
}

bool BlockSystem::factorise() noexcept {
  constexpr double kRelativePivot = 1e-13;
  for (std::size_t j = 0; j < size_; ++j) {
    double d = at(j, j);
    for (std::size_t k = 0; k < j; ++k) {
      d -= l_[j * size_ + k] * l_[j * size_ + k];
    }
    if (!(d > kRelativePivot * at(j, j)) || !std::isfinite(d)) {
      return false;
    }
    l_[j * size_ + j] = std::sqrt(d);
    for (std::size_t i = j + 1; i < size_; ++i) {
      double s = at(i, j);
      for (std::size_t k = 0; k < j; ++k) {
        s -= l_[i * size_ + k] * l_[j * size_ + k];
      }
      l_[i * size_ + j] = s / l_[j * size_ + j];
    }
  }
  return true;
}

void BlockSystem::solve_in_place(std::span<double> x) const noexcept {
  for (std::size_t i = 0; i < size_; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      x[i] -= l_[i * size_ + k] * x[k];
    }
    x[i] /= l_[i * size_ + i];
  }
  for (std::size_t i = size_; i-- > 0;) {
    for (std::size_t k = i + 1; k < size_; ++k) {
      x[i] -= l_[k * size_ + i] * x[k];
    }
    x[i] /= l_[i * size_ + i];
  }
}

void BlockSystem::solve() noexcept {
  std::transform(g_.begin(), g_.begin() + static_cast<std::ptrdiff_t>(size_), step_.begin(),
                 [](double g) { return -g; });
  solve_in_place(step_);
}

double BlockSystem::decrement() const noexcept {
  return -std::inner_product(g_.begin(), g_.begin() + static_cast<std::ptrdiff_t>(size_),
                             step_.begin(), 0.0);
}

void BlockSystem::invert() noexcept {
  for (std::size_t c = 0; c < size_; ++c) {
    const std::span<double> column = inverse_.subspan(c * size_, size_);  // Symmetric: a row.
    std::fill(column.begin(), column.end(), 0.0);
    column[c] = 1.0;
    solve_in_place(column);
  }
}

namespace {

// c = a b, b being symmetric.
void multiply(std::span<const double> a, std::span<const double> b, std::size_t size,
              std::span<double> c) noexcept {
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
      const auto row = a.subspan(i * size, size);
      c[i * size + j] =
          std::inner_product(row.begin(), row.end(), b.subspan(j * size, size).begin(), 0.0);
    }
  }
}

}  // namespace

void BlockSystem::sandwich() noexcept {
  multiply(inverse_, h_, size_, l_);
  multiply(l_, inverse_, size_, h_);
  std::copy_n(h_.begin(), size_ * size_, inverse_.begin());
}

}  // namespace dseam::splice
