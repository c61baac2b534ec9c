// SPDX-License-Identifier: Apache-2.0
#include "config/key_tables.hpp"

namespace dseam::program {

std::vector<Key> camera_keys(LiveSettings& c) {
  return {
      {"camera", "views", &c.views, "Frames that are taken of a real camera", "", 1, 16},
      {"camera", "settle_s", &c.settle_s,
       "After a view, frames are thrown away for so long: the time to drive to the next", "s", 0,
       600},
      {"camera", "poses", &c.poses,
       "A scene_camera.json with the pose of each view, as it was taught; empty for none"},
      {"camera", "pose_interface", &c.pose_interface,
       "CAN interface on which the robot reports its flange during the scan; empty for none"},
      {"camera", "gray_device", &c.gray_device,
       "Where the gray image comes from: a second device (V4L2: node, Aravis: id), or the camera's "
       "own id for both in one frame (Aravis); empty for none"},
      {"camera", "width", &c.width, "Columns; 0 as the device has them", "pixels", 0, 8192},
      {"camera", "height", &c.height, "Rows; 0 as the device has them", "pixels", 0, 8192},
      {"camera", "format", &c.format, "V4L2: format of the depth, up to four characters"},
      {"camera", "mm_per_count", &c.mm_per_count,
       "Millimetres a count of depth, where the device does not say; 0: it does", "mm", 0, 100},
      {"camera", "focal_px", &c.focal_px,
       "Focal length, where the device does not say; the image's middle is on the axis", "pixels",
       0, 1e5},
  };
}

}  // namespace dseam::program
