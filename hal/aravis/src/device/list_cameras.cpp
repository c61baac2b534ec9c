// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "device/device.hpp"

namespace dseam::hal::aravis {
namespace {

std::string text_or_empty(const char* text) { return text == nullptr ? "" : text; }

}  // namespace

std::vector<CameraInfo> list_cameras() {
  arv_update_device_list();
  std::vector<CameraInfo> cameras;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    cameras.push_back({.backend = "aravis",
                       .id = text_or_empty(arv_get_device_id(i)),
                       .model = text_or_empty(arv_get_device_vendor(i)) + " " +
                                text_or_empty(arv_get_device_model(i)),
                       .address = text_or_empty(arv_get_device_address(i)),
                       .why_not = {}});
  }
  for (CameraInfo& camera : cameras) {
    AravisConfig config;
    config.id = camera.id;
    ControlLine line;
    (void)connect(config, aravis_library(), line, camera.why_not);
  }
  return cameras;
}

}  // namespace dseam::hal::aravis
