// SPDX-License-Identifier: Apache-2.0
#include "dseam/base/expects.hpp"

namespace dseam {
namespace {

// Set during set-up, read only when the program is already lost: no synchronisation is owed.
FaultHandler installed_handler = nullptr;

}  // namespace

FaultHandler set_fault_handler(FaultHandler handler) noexcept {
  FaultHandler before = installed_handler;
  installed_handler = handler;
  return before;
}

void precondition_broken(const char* condition, const char* file, int line) noexcept {
  if (installed_handler != nullptr) {
    installed_handler(condition, file, line);
  }
  __builtin_trap();
}

}  // namespace dseam
