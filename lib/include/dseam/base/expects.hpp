// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dseam {

/// What a broken precondition calls. It must not return; when it does, the program is trapped.
using FaultHandler = void (*)(const char* condition, const char* file, int line) noexcept;

/// Installs the handler and returns the one before; nullptr restores the default, which traps.
///
/// Context: set-up only, before any other thread runs.
FaultHandler set_fault_handler(FaultHandler handler) noexcept;

[[noreturn]] void precondition_broken(const char* condition, const char* file, int line) noexcept;

}  // namespace dseam

/// A precondition of the caller. Never for input from a file, a user or a device: that is Errc's.
#define DSEAM_EXPECTS(condition)          \
  (static_cast<bool>(condition) ? void(0) \
                                : ::dseam::precondition_broken(#condition, __FILE__, __LINE__))

/// Marks a function of the cycle path: no heap, no lock, no system call that blocks.
/// Where the compiler has RealtimeSanitizer (clang 20 and later) it is checked at run time.
#if defined(__clang__) && __clang_major__ >= 20
#define DSEAM_NONBLOCKING [[clang::nonblocking]]
#else
#define DSEAM_NONBLOCKING
#endif
