// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace dseam::rt {

/// The system calls of thread set-up, so that each can be made to fail in a test. All return 0 or
/// an error number.
struct RtSys {
  int (*lock_memory)() noexcept;
  int (*set_fifo)(int priority) noexcept;
  int (*set_deadline)(std::uint64_t runtime_ns, std::uint64_t deadline_ns,
                      std::uint64_t period_ns) noexcept;
  int (*pin_to_cpu)(int cpu) noexcept;
};

/// The real ones, for the calling thread.
[[nodiscard]] const RtSys& real_rt_sys() noexcept;

}  // namespace dseam::rt
