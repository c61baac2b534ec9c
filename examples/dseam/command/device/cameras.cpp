// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include "command/commands.hpp"
#include "scan/live_scan.hpp"

namespace dseam::program {

ExitCode run_cameras(const CamerasOptions& /*options*/, const Invocation& /*invocation*/) {
  for (const hal::CameraInfo& camera : list_all_cameras()) {
    std::cout << camera.backend << ':' << camera.id << "  " << camera.model << "  "
              << camera.address << '\n';
    if (!camera.why_not.empty()) {
      std::cout << "  cannot be opened: " << camera.why_not << '\n';
    }
  }
  std::cout << "sim  the simulated cell\n";
  return ExitCode::kDone;
}

}  // namespace dseam::program
