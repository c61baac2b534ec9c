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
};

/// The runtime's and the bus' part of the catalogue (cases 12 to 30 and 40, as far as a session
/// sees them).
[[nodiscard]] const std::vector<FaultKind>& fault_kinds();

}  // namespace dseam::test
