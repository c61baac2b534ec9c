// SPDX-License-Identifier: Apache-2.0
#include "config/key_tables.hpp"

namespace dseam::program {

std::vector<Key> session_keys(WeldRun::Config& config) {
  rt::ArcGate::Config& arc = config.session.arc;
  link::Addressing& addressing = config.link.addressing;
  return {
      {"rt", "allow_degraded", &config.session.allow_degraded,
       "Arm although the system is not real-time"},
      {"rt", "min_confidence", &arc.min_confidence, "The arc goes off below it", "", 0.01, 1},
      {"rt", "max_tracking_mm", &arc.max_tracking_mm,
       "The arc goes off when the torch is farther from where it was sent", "mm", 0.1, 100},
      {"rt", "max_corridor_mm", &arc.max_corridor_mm,
       "The arc goes off when the torch is farther beside the path", "mm", 0.1, 100},
      {"rt", "max_speed_mm_s", &config.session.motion.max_speed_mm_s,
       "A path with a faster set point is not sent at all", "mm/s", 1, 5000},
      {"link", "base_id", &addressing.base_id, "Identifier of the link's first message", "", 0,
       2047 - link::kMessageCount},
      {"link", "classic", &addressing.classic, "Segments of 8 bytes instead of CAN FD"},
  };
}

}  // namespace dseam::program
