// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/linux/thread_setup.hpp"

#include <sched.h>
#include <sys/resource.h>

#include <cerrno>

namespace dseam::rt {
namespace {

constexpr std::uintptr_t kPageBytes = 4096;
constexpr std::uintptr_t kPages = 32;  // Four times the deepest path of the cycle.

bool is_valid(const ThreadConfig& c) noexcept {
  const bool fifo = c.policy != Policy::kFifo || (c.priority >= 1 && c.priority <= 98);
  const bool deadline =
      c.policy != Policy::kDeadline ||
      (c.runtime_ns > 0 && c.runtime_ns <= c.deadline_ns && c.deadline_ns <= c.period_ns);
  return c.policy <= Policy::kDeadline && fifo && deadline && c.cpu < CPU_SETSIZE;
}

int set_policy(const ThreadConfig& c, const RtSys& sys) noexcept {
  switch (c.policy) {
    case Policy::kFifo:
      return sys.set_fifo(c.priority);
    case Policy::kDeadline:
      return sys.set_deadline(c.runtime_ns, c.deadline_ns, c.period_ns);
    default:
      return EPERM;  // Nobody refused it, but it is no real time either.
  }
}

}  // namespace

Result<ThreadReport> set_up_thread(const ThreadConfig& config, const RtSys& sys) noexcept {
  if (!is_valid(config)) {
    return Errc::kInvalidArgument;
  }
  ThreadReport report;
  // A thread with SCHED_DEADLINE may not be pinned any more, so the processor comes first.
  report.cpu_error = config.cpu >= 0 ? sys.pin_to_cpu(config.cpu) : 0;
  report.memory_error = config.lock_memory ? sys.lock_memory() : 0;
  prefault_stack();
  report.policy_error = set_policy(config, sys);
  return report;
}

void prefault_stack() noexcept {
  const auto here = reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0));
  for (std::uintptr_t page = 1; page <= kPages; ++page) {
    // Below the stack pointer lies nothing of anybody's; the kernel maps it by the touch.
    *reinterpret_cast<volatile char*>(here - page * kPageBytes) = 0;
  }
}

ThreadFaults thread_faults() noexcept {
  rusage usage{};
  (void)getrusage(RUSAGE_THREAD, &usage);
  return {usage.ru_minflt, usage.ru_majflt, usage.ru_nivcsw};
}

}  // namespace dseam::rt
