// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "dseam/base/arena.hpp"

namespace dseam::pipeline {

/// Owns the memory of one pipeline: the only template on a capacity in lib/.
///
/// A static object on a microcontroller, one allocation at start elsewhere. The budget is the type,
/// so `static_assert(sizeof(ScanWorkspace<...>) <= ...)` states it, and make() of what is built in
/// it says kOutOfMemory when it is not kept.
///
/// Context: set-up; it must outlive everything that was made in its arena.
template <std::size_t kBytes>
class ScanWorkspace {
 public:
  ScanWorkspace() noexcept : arena_({&memory_[0], kBytes}) {}
  ScanWorkspace(const ScanWorkspace&) = delete;
  ScanWorkspace& operator=(const ScanWorkspace&) = delete;

  [[nodiscard]] Arena& arena() noexcept { return arena_; }

 private:
  alignas(64) std::byte memory_[kBytes];  // Left as it is: the arena initialises what it hands out.
  Arena arena_;
};

}  // namespace dseam::pipeline
