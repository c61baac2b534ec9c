// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/cycle.hpp"

namespace dseam::rt {

Result<Cycle> Cycle::make(const Config& config, hal::Clock& clock) noexcept {
  if (config.period_ns < 100'000 || config.gap_ns < config.period_ns) {
    return Errc::kInvalidArgument;
  }
  return Cycle(config, clock);
}

Cycle::Tick Cycle::wait() noexcept {
  const std::int64_t now_ns = clock_->now_ns();
  Tick tick;
  if (ticks_ == 0) {
    due_ns_ = now_ns;
  }
  due_ns_ += config_.period_ns;
  if (now_ns > due_ns_) {
    const std::int64_t missed = (now_ns - due_ns_ + config_.period_ns - 1) / config_.period_ns;
    due_ns_ += missed * config_.period_ns;
    tick.skipped = static_cast<std::uint64_t>(missed);
  }
  clock_->sleep_until(due_ns_);
  tick.due_ns = due_ns_;
  tick.woke_ns = clock_->now_ns();
  const auto lost_ns = static_cast<std::int64_t>(tick.skipped) * config_.period_ns;
  tick.gap = tick.woke_ns - due_ns_ > config_.gap_ns || lost_ns > config_.gap_ns;
  skipped_ += tick.skipped;
  ++ticks_;
  return tick;
}

}  // namespace dseam::rt
