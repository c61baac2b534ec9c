// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/linux/last_gasp.hpp"

#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>

namespace dseam::rt::last_gasp {
namespace {

constexpr int kTimes = 3;
constexpr int kEnding[] = {SIGTERM, SIGINT, SIGHUP};
constexpr int kDefects[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

/// Two places, so that a handler never sees a frame that is half written.
struct Frame {
  int fd = -1;
  std::size_t size_bytes = 0;
  std::array<std::byte, kMaxBytes> bytes{};
};
std::array<Frame, 2> frames;
std::atomic<const Frame*> armed{nullptr};
std::atomic<bool> stopping{false};
static_assert(std::atomic<const Frame*>::is_always_lock_free);
static_assert(std::atomic<bool>::is_always_lock_free);

/// Async-signal-safe: loads, and write().
void speak() noexcept {
  const Frame* frame = armed.load(std::memory_order_acquire);
  for (int i = 0; frame != nullptr && i < kTimes; ++i) {
    const ssize_t written = write(frame->fd, frame->bytes.data(), frame->size_bytes);
    static_cast<void>(written);  // There is nobody left to tell.
  }
}

/// Whoever watched the signals to end before; they are told as well.
std::array<void (*)(int), std::size(kEnding)> others{};

void on_ending(int signal_number) noexcept {
  const int error = errno;
  speak();
  stopping.store(true, std::memory_order_release);
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (kEnding[i] == signal_number && others[i] != nullptr) {
      others[i](signal_number);
    }
  }
  errno = error;
}

void remember_others() noexcept {
  for (std::size_t i = 0; i < others.size(); ++i) {
    struct sigaction before {};
    const bool handled = sigaction(kEnding[i], nullptr, &before) == 0 &&
                         before.sa_handler != SIG_DFL && before.sa_handler != SIG_IGN;
    if (handled && before.sa_handler != on_ending) {
      others[i] = before.sa_handler;
    }
  }
}

void on_defect(int signal_number) noexcept {
  speak();
  raise(signal_number);  // SA_RESETHAND: this time it takes its usual course.
}

template <std::size_t kCount>
bool set_handler(const int (&signals)[kCount], void (*handler)(int), int flags) noexcept {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  bool all = true;
  for (const int signal_number : signals) {
    all = sigaction(signal_number, &action, nullptr) == 0 && all;
  }
  return all;
}

}  // namespace

Result<> install() noexcept {
  remember_others();
  const int once = static_cast<int>(SA_RESETHAND);
  const bool ending = set_handler(kEnding, on_ending, once | SA_RESTART);
  const bool defects = set_handler(kDefects, on_defect, once | SA_NODEFER);
  return ending && defects ? Result<>() : Errc::kUnavailable;
}

Result<> prepare(int fd, std::span<const std::byte> frame) noexcept {
  if (fd < 0 || frame.empty() || frame.size() > kMaxBytes) {
    return Errc::kInvalidArgument;
  }
  Frame& other = armed.load(std::memory_order_relaxed) == &frames[0] ? frames[1] : frames[0];
  other.fd = fd;
  other.size_bytes = frame.size();
  std::memcpy(other.bytes.data(), frame.data(), frame.size());
  armed.store(&other, std::memory_order_release);
  return {};
}

void disarm() noexcept { armed.store(nullptr, std::memory_order_release); }

bool stop_requested() noexcept { return stopping.load(std::memory_order_acquire); }

}  // namespace dseam::rt::last_gasp
