// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "dseam/base/arena.hpp"

namespace dseam::test {

/// An arena with heap memory of its own, for tests only.
class ArenaOwner {
 public:
  explicit ArenaOwner(std::size_t size_bytes) : memory_(size_bytes), arena_(memory_) {}
  Arena& arena() { return arena_; }

 private:
  std::vector<std::byte> memory_;
  Arena arena_;
};

}  // namespace dseam::test
