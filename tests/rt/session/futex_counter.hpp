// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/filter.h>
#include <linux/futex.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>

namespace dseam::test {

/// Counts the futex calls of the calling thread from construction to its end: the kernel hands each
/// of them to us instead of doing it, also those that a lock makes inside the C library. A wait is
/// answered with "look again"; a wake is passed on, or whoever waits would do so for ever. There is
/// no way back, so that the thread must be one of the test's own.
class FutexCounter {
 public:
  FutexCounter() noexcept {
    struct sigaction action {};
    action.sa_sigaction = &on_call;
    action.sa_flags = SA_SIGINFO | SA_NODEFER;
    std::array<sock_filter, 6> program{{
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_futex, 0, 3),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, args[5])),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kPassedOn, 1, 0),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    }};
    const sock_fprog filter{program.size(), program.data()};
    counting_ = ::sigaction(SIGSYS, &action, nullptr) == 0 &&
                ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
                ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
    before_ = calls_;
  }

  /// False where the kernel lets no filter in: then count() means nothing.
  [[nodiscard]] bool counting() const noexcept { return counting_; }
  [[nodiscard]] std::uint64_t count() const noexcept { return calls_ - before_; }

 private:
  static constexpr std::uint32_t kPassedOn = 0x77616b65;  ///< In an argument that a wake ignores.

  /// Every caller must look again after EAGAIN, so that locks still work, only slowly.
  static long answer(long address, long operation, long count) noexcept {
    const bool wake = (operation & FUTEX_CMD_MASK) == FUTEX_WAKE;
    return wake ? ::syscall(SYS_futex, address, operation, count, 0L, 0L, long{kPassedOn})
                : -EAGAIN;
  }
  static void on_call(int, siginfo_t*, void* context) noexcept {
    ++calls_;
    auto& registers = static_cast<ucontext_t*>(context)->uc_mcontext;
#if defined(__x86_64__)
    auto& r = registers.gregs;
    r[REG_RAX] = answer(r[REG_RDI], r[REG_RSI], r[REG_RDX]);
#elif defined(__aarch64__)
    auto& r = registers.regs;
    r[0] = static_cast<std::uint64_t>(
        answer(static_cast<long>(r[0]), static_cast<long>(r[1]), static_cast<long>(r[2])));
#else
#error "where does this processor hold the arguments of a system call?"
#endif
  }

  static inline std::atomic<std::uint64_t> calls_{0};
  bool counting_ = false;
  std::uint64_t before_ = 0;
};

}  // namespace dseam::test
