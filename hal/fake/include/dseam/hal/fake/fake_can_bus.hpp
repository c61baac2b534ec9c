// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "dseam/base/random.hpp"
#include "dseam/hal/can_bus.hpp"
#include "dseam/hal/clock.hpp"
#include "dseam/hal/fake/device_fault.hpp"

namespace dseam::hal::fake {

/// One end of a cable between two fakes: a script of what goes wrong with the frames it receives.
///
/// Memory:  its own inbox; no heap.
/// Context: one thread for both ends.
class FakeCanBus final : public CanBus {
 public:
  static constexpr std::size_t kInbox = 128;

  explicit FakeCanBus(Clock& clock) noexcept : clock_(clock) {}
  /// Joins the two ends; both must outlive their use.
  void join(FakeCanBus& other) noexcept;

  /// From now on each frame that arrives takes a turn of `script`; afterwards frames come whole.
  void play(const FaultScript& script) noexcept {
    script_ = script;
    playing_ = true;
  }
  [[nodiscard]] bool script_done() const noexcept { return script_.done(); }
  /// kDown and kBusOff: as if pulled; kErrorActive: back again.
  void set_state(BusState state) noexcept;

 private:
  Result<> do_send(const CanFrame& frame) noexcept override;
  Result<CanFrame> do_receive(std::chrono::nanoseconds timeout) noexcept override;
  Result<> do_purge() noexcept override { return {}; }  // What was sent has arrived.
  [[nodiscard]] BusHealth do_health() const noexcept override { return health_; }

  [[nodiscard]] bool gone() const noexcept {
    return health_.state == BusState::kDown || health_.state == BusState::kBusOff;
  }
  void arrive(const CanFrame& frame) noexcept;
  void put(const CanFrame& frame) noexcept;
  void make_garbage(CanFrame& frame) noexcept;

  Clock& clock_;
  FakeCanBus* other_ = nullptr;
  FaultScript script_;
  bool playing_ = false;
  std::array<CanFrame, kInbox> inbox_;
  std::size_t first_ = 0;
  std::size_t waiting_ = 0;
  CanFrame before_;
  BusHealth health_;
  Pcg32 random_{1};
};

}  // namespace dseam::hal::fake
