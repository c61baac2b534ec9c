// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <initializer_list>
#include <span>
#include <vector>

#include "rt/session/cell/virtual_cell.hpp"

namespace dseam::test {

/// One kind of trouble, how to make it and how to end it, and what may be latched for it.
struct FaultKind {
  const char* name;
  std::function<void(VirtualCell&)> begin;
  std::function<void(VirtualCell&)> end;
  std::vector<rt::Fault> expected;  ///< Two where either end may be the first to notice.
  std::int64_t lasts_ns = 300'000'000;
  /// What rises where it is borne: nothing goes unnoticed.
  std::function<std::uint64_t(const VirtualCell&)> counted = {};
  bool each = false;  ///< Once for each frame that was tampered with, no more and no less.
};

/// What of the catalogue a session meets: the camera's cases 1 to 9, the bus' and the runtime's 12
/// to 30.
[[nodiscard]] const std::vector<FaultKind>& fault_kinds();

}  // namespace dseam::test
