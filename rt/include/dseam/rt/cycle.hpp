// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/base/expects.hpp"
#include "dseam/base/result.hpp"
#include "dseam/hal/clock.hpp"

namespace dseam::rt {

/// Wakes its thread at even, absolute times. A period that was missed is skipped and counted,
/// never made up for with a burst.
///
/// Context: the cycle thread.
class Cycle {
 public:
  struct Config {
    std::int64_t period_ns = 1'000'000;
    std::int64_t gap_ns = 50'000'000;  ///< Waking later than this is a jump of the clock.
  };
  struct Tick {
    std::int64_t due_ns = 0;
    std::int64_t woke_ns = 0;
    std::uint64_t skipped = 0;  ///< Periods left out before this one.
    bool gap = false;
  };

  /// Errors:  kInvalidArgument: a period under 100 us or a gap under the period.
  [[nodiscard]] static Result<Cycle> make(const Config& config, hal::Clock& clock) noexcept;

  /// Sleeps to the next even time. The first call sets the phase and returns one period later.
  DSEAM_NONBLOCKING Tick wait() noexcept;
  [[nodiscard]] std::uint64_t skipped() const noexcept { return skipped_; }
  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }

 private:
  Cycle(const Config& config, hal::Clock& clock) noexcept : config_(config), clock_(&clock) {}

  Config config_;
  hal::Clock* clock_;
  std::int64_t due_ns_ = 0;
  std::uint64_t skipped_ = 0;
  std::uint64_t ticks_ = 0;
};

}  // namespace dseam::rt
