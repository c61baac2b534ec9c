// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include "dseam/base/expects.hpp"

namespace dseam {

/// An appendable array over lent storage. It never grows: a full one says so and counts nothing.
///
/// Memory:  none of its own; copies share the storage but not the size, so pass by reference.
template <typename T>
class Buffer {
 public:
  constexpr Buffer() = default;
  explicit constexpr Buffer(std::span<T> storage) noexcept : storage_(storage) {}

  constexpr void clear() noexcept { size_ = 0; }
  /// False, and nothing changed, when the buffer is full.
  [[nodiscard]] constexpr bool append(T value) noexcept {
    if (size_ == storage_.size()) {
      return false;
    }
    storage_[size_++] = std::move(value);
    return true;
  }
  /// Sets the size without touching the elements; for code that writes through storage().
  constexpr void resize(std::size_t size) noexcept {
    DSEAM_EXPECTS(size <= storage_.size());
    size_ = size;
  }

  [[nodiscard]] constexpr T& operator[](std::size_t i) noexcept { return storage_[i]; }
  [[nodiscard]] constexpr const T& operator[](std::size_t i) const noexcept { return storage_[i]; }
  [[nodiscard]] constexpr std::size_t size() const noexcept { return size_; }
  [[nodiscard]] constexpr std::size_t capacity() const noexcept { return storage_.size(); }
  [[nodiscard]] constexpr bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] constexpr bool full() const noexcept { return size_ == storage_.size(); }
  [[nodiscard]] constexpr std::span<T> storage() const noexcept { return storage_; }
  [[nodiscard]] constexpr std::span<T> items() noexcept { return storage_.first(size_); }
  [[nodiscard]] constexpr std::span<const T> view() const noexcept { return storage_.first(size_); }

 private:
  std::span<T> storage_;
  std::size_t size_ = 0;
};

}  // namespace dseam
