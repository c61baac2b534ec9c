// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "dseam/hal/camera/camera_info.hpp"
#include "dseam/link/sender.hpp"
#include "scan/live_settings.hpp"
#include "scan/scan.hpp"

namespace dseam::program {

/// A real camera of the backend `kind` ("aravis" or "v4l2"). Its views have the poses that were
/// taught, or those that the robot reports on a CAN interface, or none.
///
/// Errors:  throws Failure: kDevice with the cure, kUsage where the backend was not built.
[[nodiscard]] std::unique_ptr<ScanSource> open_live_scan(const std::string& kind,
                                                         const std::string& id,
                                                         const LiveSettings& settings,
                                                         const link::Sender::Config& link);

/// Every camera that any backend can see.
[[nodiscard]] std::vector<hal::CameraInfo> list_all_cameras();

}  // namespace dseam::program
