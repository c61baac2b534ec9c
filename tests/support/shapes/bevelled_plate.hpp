// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "dseam/depth/depth_image.hpp"
#include "dseam/splice/spliced_view.hpp"

namespace dseam::test {

/// A pipe upright through a hole in a plate, the hole's upper edge cut off at 45 degrees.
///
/// Frame:   base: the plate's outside is z = 0, the pipe's axis x = y = 0.
struct BevelledPlate {
  double pipe_radius_mm = 40.0;
  double gap_mm = 1.0;
  double bevel_mm = 3.0;
  double wall_mm = 10.0;
  double noise_mm = 0.02;
  int smear_px = 0;  ///< Each depth is the mean of a square that reaches so far.

  [[nodiscard]] double edge_radius_mm() const { return pipe_radius_mm + gap_mm + bevel_mm; }
};

/// Six views from all round, with exact poses.
class BevelledPlateScan {
 public:
  explicit BevelledPlateScan(const BevelledPlate& plate);

  [[nodiscard]] const std::vector<depth::DepthImage>& frames() const { return frames_; }
  [[nodiscard]] const std::vector<splice::ReportedPose>& poses() const { return poses_; }

 private:
  std::vector<std::vector<std::uint16_t>> depth_;
  std::vector<depth::DepthImage> frames_;
  std::vector<splice::ReportedPose> poses_;
};

}  // namespace dseam::test
