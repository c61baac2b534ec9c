// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>

#include "dseam/base/expects.hpp"

namespace dseam {

/// Hands out pieces of lent memory during set-up, then is sealed and hands out no more.
///
/// The one way in which stages get their buffers: on Linux the bytes come from one mapping, on a
/// microcontroller from a static array. What does not fit is remembered, so that a set-up function
/// takes all it needs and asks `exhausted()` once at its end.
///
/// Memory:  nothing of its own; the lent bytes must outlive every span that was handed out.
/// Time:    O(bytes handed out), since they are value-initialised.
/// Context: set-up; one thread.
class Arena {
 public:
  /// Bytes that `count` objects of T may use up, alignment included.
  template <typename T>
  [[nodiscard]] static constexpr std::size_t bytes(std::size_t count) noexcept {
    return count * sizeof(T) + alignment_of<T>() - 1;
  }

  explicit Arena(std::span<std::byte> memory) noexcept : memory_(memory) {}
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  /// `count` value-initialised objects; an empty span, and exhausted(), when they do not fit.
  template <typename T>
  [[nodiscard]] std::span<T> take(std::size_t count) noexcept {
    static_assert(std::is_trivially_destructible_v<T>, "the arena destroys nothing");
    DSEAM_EXPECTS(!sealed_);
    std::byte* place = reserve(count, sizeof(T), alignment_of<T>());
    if (place == nullptr) {
      return {};
    }
    T* first = reinterpret_cast<T*>(place);  // NOLINT: the bytes become objects on the next line.
    std::uninitialized_value_construct_n(first, count);
    return {first, count};
  }

  /// From here on take() is a broken precondition.
  void seal() noexcept { sealed_ = true; }

  [[nodiscard]] bool exhausted() const noexcept { return exhausted_; }
  [[nodiscard]] std::size_t used_bytes() const noexcept { return used_bytes_; }
  [[nodiscard]] std::size_t size_bytes() const noexcept { return memory_.size(); }

 private:
  /// At least a SIMD register's width, so that hot loops start aligned.
  template <typename T>
  [[nodiscard]] static constexpr std::size_t alignment_of() noexcept {
    return alignof(T) > 32 ? alignof(T) : 32;
  }

  std::byte* reserve(std::size_t count, std::size_t size_bytes, std::size_t alignment) noexcept;

  std::span<std::byte> memory_;
  std::size_t used_bytes_ = 0;
  bool sealed_ = false;
  bool exhausted_ = false;
};

}  // namespace dseam
