// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace dseam::hal::fake {

/// What a device can do wrong: one vocabulary for cameras and buses.
enum class DeviceFault : std::uint8_t {
  kNone,
  kOff,           ///< Nothing comes.
  kStuck,         ///< The same again, time stamp and all.
  kGarbage,       ///< Random content.
  kWrong,         ///< Well formed, but not what was agreed: another size, another identifier.
  kSlow,          ///< At a quarter of the rate.
  kDelayed,       ///< On time by rate, but old.
  kIntermittent,  ///< Every second one is missing.
  kLost,          ///< Sent by the device and lost on the way: a gap in its sequence.
  kTruncated,     ///< Shorter than promised.
  kUnplugged,     ///< The device is gone.
  kClockJump,     ///< The device's clock is set forward by an hour, once.
};

/// `count` frames or messages of one kind.
struct FaultStep {
  DeviceFault fault = DeviceFault::kNone;
  std::uint32_t count = 1;
};

/// What a fake device will do, played once; afterwards the device is off.
class FaultScript {
 public:
  FaultScript() = default;
  explicit constexpr FaultScript(std::span<const FaultStep> steps) noexcept : steps_(steps) {}

  struct Turn {
    DeviceFault fault = DeviceFault::kOff;
    std::uint32_t index = 0;  ///< Which of its step.
  };

  constexpr Turn next() noexcept {
    while (step_ < steps_.size() && played_ == steps_[step_].count) {
      ++step_;
      played_ = 0;
    }
    return done() ? Turn{} : Turn{steps_[step_].fault, played_++};
  }
  /// Tests end by expecting this: a script that was not played to its end tested less than it says.
  [[nodiscard]] constexpr bool done() const noexcept {
    const bool in_last = step_ + 1 == steps_.size() && played_ == steps_[step_].count;
    return step_ >= steps_.size() || in_last;
  }

 private:
  std::span<const FaultStep> steps_;
  std::size_t step_ = 0;
  std::uint32_t played_ = 0;
};

}  // namespace dseam::hal::fake
