// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dseam::program {

/// What a real camera does not say of itself, and how its views are taken.
struct LiveSettings {
  std::uint32_t views = 6;
  double settle_s = 0.0;       ///< What came earlier than this after the view before is not used.
  std::string poses;           ///< scene_camera.json with the camera's taught poses.
  std::string pose_interface;  ///< CAN interface on which the robot reports its flange.
  std::string gray_device;     ///< A second node or camera with the gray image.
  std::uint32_t width = 0;     ///< V4L2; 0: as the device has it.
  std::uint32_t height = 0;
  std::string format = "Z16";  ///< V4L2: four characters.
  double mm_per_count = 0.0;   ///< V4L2: what one count of depth is,
  double focal_px = 0.0;       ///< and the lens; the principal point is the image's middle.
};

}  // namespace dseam::program
