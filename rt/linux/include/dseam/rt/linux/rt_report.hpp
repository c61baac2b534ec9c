// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/rt/linux/thread_setup.hpp"

namespace dseam::rt {

/// What this machine gives to real-time threads. Texts are empty where the system does not say.
struct RtReport {
  using Text = std::array<char, 64>;

  Text kernel{};            ///< uname -r
  bool preempt_rt = false;  ///< /sys/kernel/realtime
  Text clock_source{};      ///< tsc is the one to have.
  Text governor{};          ///< Of the first processor; `performance` is the one to have.
  Text isolated_cpus{};
  std::int64_t throttled_us = 0;    ///< RT threads are stopped for so long in each
  std::int64_t throttle_us = 0;     ///< of these; 0 and 0: never.
  std::uint64_t memlock_bytes = 0;  ///< The limit; all ones: none.
  int processors = 0;
  ThreadReport thread;  ///< What the calling thread was granted, where it asked.

  /// Everything that a cycle of 1 kHz should not go without is there.
  [[nodiscard]] bool ready() const noexcept { return preempt_rt && thread.real_time(); }
};

/// Reads the machine's state; `thread` is what set_up_thread() said.
///
/// Context: set-up; reads files.
[[nodiscard]] RtReport rt_report(const ThreadReport& thread) noexcept;

/// One line a finding with its cure, as `dseam rt-report` prints it. Returns the text's length;
/// what does not fit is cut off.
std::size_t format(const RtReport& report, std::span<char> out) noexcept;

}  // namespace dseam::rt
