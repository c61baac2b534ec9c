// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "dseam/hal/v4l2/v4l2_camera.hpp"

namespace dseam::test {

/// The kernel's virtual video driver: it streams, and it fails when it is told to.
class Vivid {
 public:
  static constexpr const char* kCapture = "/dev/video0";

  /// Sets a control of the driver by a part of its name; a button is pressed by any value.
  /// False when there is no such control or the driver refused.
  static bool set(const std::string& name, std::int32_t value);

  /// Y16 at the webcam's smallest size, the nearest to depth that the driver has.
  static hal::v4l2::V4l2Config config();
};

/// How many descriptors and mappings this process holds.
inline std::size_t open_descriptors() {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    ++count;
  }
  return count;
}
[[nodiscard]] std::size_t video_mappings();

}  // namespace dseam::test
