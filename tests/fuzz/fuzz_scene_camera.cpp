// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "dseam/hal/replay/scan_set.hpp"

/// What is accepted is usable: real intrinsics, and poses that are rigid.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto read = dseam::hal::replay::parse_scene_camera(text, "scene_camera.json");
  if (!read.ok()) {
    return read.fault().rfind("scene_camera.json: ", 0) == 0 ? 0 : (std::abort(), 0);
  }
  for (const auto& camera : read.value()) {
    const bool usable = camera.intrinsics.fx > 0.0 && camera.intrinsics.fy > 0.0 &&
                        std::isfinite(camera.intrinsics.cx) && camera.mm_per_count > 0.0;
    const bool rigid = !camera.T_base_camera || (camera.T_base_camera->rotation.isUnitary(1e-9) &&
                                                 camera.T_base_camera->translation_mm.allFinite());
    if (!usable || !rigid) {
      std::abort();
    }
  }
  return 0;
}
