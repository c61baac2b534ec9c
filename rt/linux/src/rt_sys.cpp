// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/linux/rt_sys.hpp"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>

namespace dseam::rt {
namespace {

/// As the kernel defines it; Debian 12's libc does not.
struct SchedAttr {
  std::uint32_t size = sizeof(SchedAttr);
  std::uint32_t policy = 6;  // SCHED_DEADLINE
  std::uint64_t flags = 0;
  std::int32_t nice = 0;
  std::uint32_t priority = 0;
  std::uint64_t runtime_ns = 0;
  std::uint64_t deadline_ns = 0;
  std::uint64_t period_ns = 0;
};

int lock_memory() noexcept {
  // Memory that is given back to the system must be faulted in again.
  (void)mallopt(M_TRIM_THRESHOLD, -1);
  (void)mallopt(M_MMAP_MAX, 0);
  return mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
}

int set_fifo(int priority) noexcept {
  sched_param param{};
  param.sched_priority = priority;
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &param);
}

int set_deadline(std::uint64_t runtime_ns, std::uint64_t deadline_ns,
                 std::uint64_t period_ns) noexcept {
  SchedAttr attr;
  attr.runtime_ns = runtime_ns;
  attr.deadline_ns = deadline_ns;
  attr.period_ns = period_ns;
  return syscall(SYS_sched_setattr, 0, &attr, 0U) == 0 ? 0 : errno;
}

int pin_to_cpu(int cpu) noexcept {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(cpu), &set);
  return pthread_setaffinity_np(pthread_self(), sizeof(set), &set);
}

constexpr RtSys kReal{lock_memory, set_fifo, set_deadline, pin_to_cpu};

}  // namespace

const RtSys& real_rt_sys() noexcept { return kReal; }

}  // namespace dseam::rt
