// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "dseam/base/arena.hpp"

namespace dseam::program {

/// One piece of memory, taken before the first frame, from which all stages get their buffers.
class LentMemory {
 public:
  explicit LentMemory(std::size_t size_bytes)
      : bytes_(std::make_unique_for_overwrite<std::byte[]>(size_bytes)),
        arena_(std::span(bytes_.get(), size_bytes)) {}

  [[nodiscard]] Arena& arena() { return arena_; }

 private:
  std::unique_ptr<std::byte[]> bytes_;
  Arena arena_;
};

}  // namespace dseam::program
