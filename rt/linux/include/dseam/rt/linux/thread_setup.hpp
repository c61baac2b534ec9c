// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "dseam/base/result.hpp"
#include "dseam/rt/linux/rt_sys.hpp"

namespace dseam::rt {

enum class Policy : std::uint8_t { kOther, kFifo, kDeadline };

/// How a thread wants to run.
struct ThreadConfig {
  Policy policy = Policy::kFifo;
  int priority = 80;  ///< kFifo: 1 to 98; 99 belongs to the kernel's own watchdogs.
  std::uint64_t runtime_ns = 300'000;   ///< kDeadline: what one period may cost,
  std::uint64_t deadline_ns = 900'000;  ///< by when,
  std::uint64_t period_ns = 1'000'000;  ///< and how often.
  int cpu = -1;                         ///< Negative: wherever the scheduler likes.
  bool lock_memory = true;
};

/// What of it was granted. 0: granted, or not asked for; otherwise the error number.
struct ThreadReport {
  int memory_error = 0;
  int policy_error = 0;
  int cpu_error = 0;

  [[nodiscard]] bool real_time() const noexcept {
    return memory_error == 0 && policy_error == 0 && cpu_error == 0;
  }
};

/// Sets up the calling thread; what is refused is reported and the rest is still done. A thread
/// that asks for kOther is never real-time.
///
/// Errors:  kInvalidArgument: a priority, a processor or times that cannot be.
/// Context: set-up, in the thread itself, before its first cycle.
[[nodiscard]] Result<ThreadReport> set_up_thread(const ThreadConfig& config,
                                                 const RtSys& sys = real_rt_sys()) noexcept;

/// Touches the stack below the caller, so that no cycle is the first to do so.
void prefault_stack() noexcept;

/// Page faults and involuntary context switches of the calling thread so far.
struct ThreadFaults {
  std::int64_t minor = 0;
  std::int64_t major = 0;
  std::int64_t preempted = 0;
};
[[nodiscard]] ThreadFaults thread_faults() noexcept;

}  // namespace dseam::rt
