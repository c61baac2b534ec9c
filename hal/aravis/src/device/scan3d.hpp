// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "dseam/base/result.hpp"
#include "dseam/depth/depth_model.hpp"
#include "dseam/hal/aravis/aravis_sys.hpp"

namespace dseam::hal::aravis {

/// Reads what the device says of its depth data; `problem` gets the reason when that is too little.
///
/// Source:  GenICam SFNC 2.7, chapter 3D Scan Control.
/// Errors:  kUnsupported: the pixel format is no depth format, or its scale is not described and
///          not assumed either. kIo: the device did not answer; nothing is assumed instead.
Result<depth::DepthModel> read_depth_model(AravisSys::Camera* camera, AravisSys& sys,
                                           const std::optional<depth::DepthModel>& assumed,
                                           std::string& problem);

/// The same of a camera whose image is gray, with one byte a pixel.
///
/// Errors:  kUnsupported: it is not Mono8. kIo: the device did not answer.
Result<depth::DepthModel> read_gray_model(AravisSys::Camera* camera, AravisSys& sys,
                                          std::string& problem);

}  // namespace dseam::hal::aravis
