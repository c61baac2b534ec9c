// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dseam::target {

/// Writes to the debugger's or the emulator's console.
void print(const char* text) noexcept;
/// What the image does after reset; its exit code.
int run_checks() noexcept;
/// Ends the emulator with this exit code.
[[noreturn]] void quit(int code) noexcept;

}  // namespace dseam::target
