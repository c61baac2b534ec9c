// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "dseam/torch/torch_path.hpp"
#include "dseam/trajectory/limits.hpp"

namespace dseam::trajectory {

/// One sample of the timed path: what goes to the robot.
///
/// Units:   time in integer microseconds from START, so that nothing drifts over an hour.
struct SetPoint {
  std::uint32_t t_us = 0;
  torch::TorchPose pose;
  double s_mm = 0.0;
  double speed_mm_s = 0.0;
  double wire_feed_m_min = 0.0;
  double voltage_v = 0.0;
  torch::Segment segment = torch::Segment::kApproach;
  LimitKind limited_by = LimitKind::kNone;
  bool arc = false;
  bool gas = false;
  bool wire = false;
  std::uint8_t pass = 0;
  std::uint8_t schedule = 0;
  seam::Confidence confidence = seam::Confidence::kHigh;  ///< Of the seam; kHigh without arc.
};

using SetPointView = std::span<const SetPoint>;

}  // namespace dseam::trajectory
