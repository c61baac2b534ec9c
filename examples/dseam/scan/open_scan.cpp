// SPDX-License-Identifier: Apache-2.0
#include "scan/open_scan.hpp"

#include "failure.hpp"
#include "scan/live_scan.hpp"
#include "scan/replay_scan.hpp"
#include "scan/sim_scan.hpp"

namespace dseam::program {

std::unique_ptr<ScanSource> open_scan(const std::string& camera, const Settings& settings) {
  const std::size_t colon = camera.find(':');
  const std::string kind = camera.substr(0, colon);
  const std::string which = colon == std::string::npos ? "" : camera.substr(colon + 1);
  if (kind == "sim" && which.empty()) {
    return std::make_unique<SimScan>(settings.cell);
  }
  if (kind == "replay" && !which.empty()) {
    return std::make_unique<ReplayScan>(which);
  }
  if ((kind == "aravis" || kind == "v4l2") && !which.empty()) {
    return open_live_scan(kind, which, settings.camera, settings.session.link);
  }
  throw Failure(ExitCode::kUsage,
                "--camera " + camera + ": sim, replay:SET, aravis:ID or v4l2:DEV is meant");
}

}  // namespace dseam::program
