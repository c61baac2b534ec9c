// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "config/settings.hpp"
#include "scan/scan.hpp"

namespace dseam::program {

/// Opens what `--camera` names: `sim`, `replay:SET`, `aravis:ID` or `v4l2:DEV`.
///
/// Errors:  throws Failure: kUsage for another word or a backend that was not built, kInput for a
///          set that is not valid, kDevice for a camera that cannot be opened, with the cure.
[[nodiscard]] std::unique_ptr<ScanSource> open_scan(const std::string& camera,
                                                    const Settings& settings);

}  // namespace dseam::program
