// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/linux/rt_report.hpp"

#include <array>
#include <cstdio>
#include <iostream>
#include <memory>

#include "command/commands.hpp"
#include "dseam/rt/cycle.hpp"
#include "dseam/rt/linux/monotonic_clock.hpp"
#include "dseam/rt/linux/thread_setup.hpp"
#include "dseam/rt/timing/histogram.hpp"
#include "terminal/interrupt.hpp"

namespace dseam::program {

namespace {

/// Runs an empty cycle of a millisecond in the calling thread and says how late it woke.
void measure_wake_up(double seconds) {
  const std::atomic<bool>& interrupted = watch_for_interrupt();
  rt::MonotonicClock clock;
  rt::Cycle cycle = rt::Cycle::make({}, clock).value();
  const auto late = std::make_unique<rt::Histogram>();
  rt::prefault_stack();
  for (double left_s = seconds; left_s > 0.0 && !interrupted; left_s -= 1e-3) {
    const rt::Cycle::Tick tick = cycle.wait();
    late->add(tick.woke_ns - tick.due_ns);
  }
  std::printf("%-14s half under %u us, 99.9 %% under %u us, worst %.1f us; %llu of %llu skipped\n",
              "wake-up", late->quantile_us(0.5), late->quantile_us(0.999),
              1e-3 * static_cast<double>(late->max_ns()),
              static_cast<unsigned long long>(cycle.skipped()),
              static_cast<unsigned long long>(cycle.ticks() + cycle.skipped()));
}

}  // namespace

ExitCode run_rt_report(const RtReportOptions& options, const Invocation& /*invocation*/) {
  const auto granted = rt::set_up_thread({});
  std::array<char, 8192> text{};
  const std::size_t size = rt::format(rt::rt_report(granted.value()), text);
  std::cout.write(text.data(), static_cast<std::streamsize>(size)).flush();
  if (options.seconds > 0.0) {
    measure_wake_up(options.seconds);
  }
  return ExitCode::kDone;
}

}  // namespace dseam::program
