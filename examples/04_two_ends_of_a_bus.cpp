// SPDX-License-Identifier: Apache-2.0
// A device behind its interface: send_position() knows a CanBus, not which. Here the scripted fake
// that is shipped for your own tests; hal/socketcan is opened in its place on a robot.
#include <cstdio>
#include <cstring>

#include "dseam/hal/fake/fake_can_bus.hpp"
#include "dseam/hal/fake/manual_clock.hpp"

namespace {

dseam::Result<> send_position(dseam::hal::CanBus& bus, float position_mm) {
  dseam::hal::CanFrame frame;
  frame.id = 0x120;
  frame.size_bytes = sizeof position_mm;
  std::memcpy(frame.data.data(), &position_mm, sizeof position_mm);
  return bus.send(frame);
}

}  // namespace

int main() {
  dseam::hal::fake::ManualClock clock;
  dseam::hal::fake::FakeCanBus here(clock);
  dseam::hal::fake::FakeCanBus there(clock);
  here.join(there);

  const bool sent = send_position(here, 12.5F).ok();
  const auto received = there.receive(std::chrono::nanoseconds(0));
  here.set_state(dseam::hal::BusState::kBusOff);
  const auto refused = send_position(here, 13.0F);

  if (!sent || !received.ok() || refused.ok()) {
    return 1;
  }
  std::printf("received %u bytes with identifier 0x%x; on a bus that is off: %s\n",
              received.value().size_bytes, received.value().id, name(refused.error()));
  return 0;
}
