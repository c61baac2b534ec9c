// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/linux/rt_report.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace dseam::rt {
namespace {

/// The first line of a file; empty when there is none.
RtReport::Text first_line(const char* path) noexcept {
  RtReport::Text text{};
  const int fd = open(path, O_RDONLY | O_CLOEXEC);
  if (fd >= 0) {
    const ssize_t got = read(fd, text.data(), text.size() - 1);
    text[got > 0 ? static_cast<std::size_t>(got) : 0] = '\0';
    text[std::strcspn(text.data(), "\n")] = '\0';
    close(fd);
  }
  return text;
}

std::int64_t number_in(const char* path, std::int64_t otherwise) noexcept {
  const RtReport::Text text = first_line(path);
  return text[0] == '\0' ? otherwise : std::strtoll(text.data(), nullptr, 10);
}

class Page {
 public:
  explicit Page(std::span<char> out) noexcept : out_(out) {}

  [[gnu::format(printf, 2, 3)]] void line(const char* format, ...) noexcept {
    va_list arguments;
    va_start(arguments, format);
    const std::size_t room = out_.size() - size_;
    const int wanted = std::vsnprintf(out_.data() + size_, room, format, arguments);
    va_end(arguments);
    size_ += room == 0 ? 0 : std::min(static_cast<std::size_t>(std::max(wanted, 0)), room - 1);
  }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  std::span<char> out_;
  std::size_t size_ = 0;
};

void granted(Page& page, const char* what, int error, const char* cure) noexcept {
  if (error == 0) {
    page.line("%-14s granted\n", what);
  } else {
    page.line("%-14s REFUSED (%s): %s\n", what, std::strerror(error), cure);
  }
}

}  // namespace

RtReport rt_report(const ThreadReport& thread) noexcept {
  RtReport report;
  report.thread = thread;
  utsname name{};
  if (uname(&name) == 0) {
    std::snprintf(report.kernel.data(), report.kernel.size(), "%.63s", name.release);
  }
  report.preempt_rt = number_in("/sys/kernel/realtime", 0) == 1;
  report.clock_source =
      first_line("/sys/devices/system/clocksource/clocksource0/current_clocksource");
  report.governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  report.isolated_cpus = first_line("/sys/devices/system/cpu/isolated");
  const std::int64_t period_us = number_in("/proc/sys/kernel/sched_rt_period_us", 0);
  const std::int64_t runtime_us = number_in("/proc/sys/kernel/sched_rt_runtime_us", -1);
  if (runtime_us >= 0 && runtime_us < period_us) {
    report.throttle_us = period_us;
    report.throttled_us = period_us - runtime_us;
  }
  rlimit limit{};
  if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0) {
    report.memlock_bytes = limit.rlim_cur;
  }
  report.processors = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
  return report;
}

std::size_t format(const RtReport& r, std::span<char> out) noexcept {
  Page page(out);
  const auto or_unknown = [](const RtReport::Text& text) {
    return text[0] == '\0' ? "unknown" : text.data();
  };
  page.line("%-14s %s, %d processors, %s\n", "kernel", or_unknown(r.kernel), r.processors,
            r.preempt_rt ? "PREEMPT_RT" : "NOT real-time: install linux-image-rt-amd64");
  page.line("%-14s %s\n", "clock source", or_unknown(r.clock_source));
  page.line("%-14s %s%s\n", "governor", or_unknown(r.governor),
            std::strcmp(r.governor.data(), "performance") == 0 || r.governor[0] == '\0'
                ? ""
                : ": cpupower frequency-set -g performance");
  page.line("%-14s %s\n", "isolated",
            r.isolated_cpus[0] == '\0' ? "none: isolcpus=, nohz_full=, irqaffinity= at boot"
                                       : r.isolated_cpus.data());
  if (r.throttled_us > 0) {
    page.line("%-14s %lld of %lld us: sysctl kernel.sched_rt_runtime_us=-1\n", "throttling",
              static_cast<long long>(r.throttled_us), static_cast<long long>(r.throttle_us));
  } else {
    page.line("%-14s none\n", "throttling");
  }
  granted(page, "memory lock", r.thread.memory_error, "ulimit -l, or CAP_IPC_LOCK");
  granted(page, "scheduling", r.thread.policy_error, "ulimit -r, or CAP_SYS_NICE");
  granted(page, "processor", r.thread.cpu_error, "is there such a processor?");
  page.line("%-14s %s\n", "verdict",
            r.ready() ? "ready" : "DEGRADED: arming needs rt.allow_degraded");
  return page.size();
}

}  // namespace dseam::rt
