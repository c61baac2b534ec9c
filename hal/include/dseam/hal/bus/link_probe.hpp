// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/hal/bus/link_port.hpp"
#include "dseam/hal/can_bus.hpp"
#include "dseam/hal/clock.hpp"
#include "dseam/link/sender.hpp"

namespace dseam::hal {

/// What a robot answered to a greeting.
struct LinkProbe {
  link::Fault fault = link::Fault::kNone;  ///< kNone: it speaks our language and is idle.
  link::Hello peer;
  std::int64_t answer_ns = 0;   ///< From HELLO to the answer.
  std::uint64_t statuses = 0;   ///< In a second after it; 50 are due.
  link::Sender::Report report;  ///< Damage, repetitions and foreign frames on the way.
  BusHealth bus;
};

/// Greets the robot on `bus` and listens for a second: nothing is armed and nothing moves.
/// The body of `dseam link-check`, after the interface itself was found in order.
[[nodiscard]] inline LinkProbe probe_link(CanBus& bus, Clock& clock,
                                          const link::Sender::Config& config,
                                          std::uint32_t session) noexcept {
  constexpr std::int64_t kStepNs = 1'000'000;
  constexpr std::int64_t kListenNs = 1'000'000'000;
  LinkProbe probe;
  Result<link::Sender> made = link::Sender::make(config);
  if (!made.ok() || !made.value().connect(session, clock.now_ns()).ok()) {
    probe.fault = link::Fault::kRefused;
    return probe;
  }
  link::Sender& sender = made.value();
  LinkPort port(bus);
  const std::int64_t start_ns = clock.now_ns();
  std::int64_t until_ns = start_ns + config.order_timeout_ns + 10 * kStepNs;
  while (clock.now_ns() < until_ns && sender.fault() == link::Fault::kNone) {
    port.turn(sender, clock.now_ns());
    if (probe.answer_ns == 0 && sender.state() == link::HostState::kIdle) {
      probe.answer_ns = clock.now_ns() - start_ns;
      probe.statuses = sender.report().statuses;
      until_ns = clock.now_ns() + kListenNs;
    }
    clock.sleep_until(clock.now_ns() + kStepNs);
  }
  probe.fault = sender.fault();
  probe.peer = sender.peer();
  probe.statuses = sender.report().statuses - probe.statuses;
  probe.report = sender.report();
  probe.bus = bus.health();
  return probe;
}

}  // namespace dseam::hal
