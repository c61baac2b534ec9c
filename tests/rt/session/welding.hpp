// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "rt/session/cell/virtual_cell.hpp"

namespace dseam::test {

inline constexpr std::int64_t kMs = 1'000'000;

inline bool weld_to_the_end(VirtualCell& cell) {
  return cell.bring_to(rt::SessionState::kRunning) &&
         cell.run_until([&] { return cell.session.state() == rt::SessionState::kIdle; },
                        6000 * kMs);
}

/// Also the vision thread is watched, and a torch that stands.
inline rt::WeldSession::Config with_vision() {
  rt::WeldSession::Config config;
  config.vision_limit_ns = 200 * kMs;
  config.arc.max_standing_ns = 300 * kMs;
  return config;
}

/// To the middle of the bead.
inline bool weld_half(VirtualCell& cell) {
  return cell.bring_to(rt::SessionState::kRunning) &&
         cell.run_until([&] { return cell.executed() > cell.path_points() / 2; }, 4000 * kMs) &&
         cell.arc_on();
}

}  // namespace dseam::test
