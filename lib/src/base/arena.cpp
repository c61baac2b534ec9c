// SPDX-License-Identifier: Apache-2.0
#include "dseam/base/arena.hpp"

namespace dseam {

std::byte* Arena::reserve(std::size_t count, std::size_t size_bytes,
                          std::size_t alignment) noexcept {
  const auto base = reinterpret_cast<std::uintptr_t>(memory_.data());  // NOLINT: to align it.
  const std::size_t padding = (alignment - (base + used_bytes_) % alignment) % alignment;
  const std::size_t free_bytes = memory_.size() - used_bytes_;
  if (padding > free_bytes || count > (free_bytes - padding) / size_bytes) {
    exhausted_ = true;
    return nullptr;
  }
  std::byte* place = memory_.data() + used_bytes_ + padding;
  used_bytes_ += padding + count * size_bytes;
  return place;
}

}  // namespace dseam
