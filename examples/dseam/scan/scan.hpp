// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dseam/depth/depth_image.hpp"
#include "dseam/hal/depth_camera.hpp"
#include "dseam/hal/robot_state.hpp"
#include "dseam/splice/spliced_view.hpp"
#include "terminal/progress.hpp"

namespace dseam::program {

/// One view as it was taken: decoded, with what the robot said of it.
struct ScannedView {
  std::vector<std::uint16_t> depth;
  std::vector<std::uint8_t> gray;
  depth::DepthImage image;  ///< Refers to the two above.
  std::int64_t captured_ns = 0;
  std::optional<geometry::RigidTransform> T_base_camera;
  std::optional<geometry::RigidTransform> T_base_flange;

  [[nodiscard]] splice::ReportedPose reported() const {
    return T_base_camera ? splice::ReportedPose{true, *T_base_camera} : splice::ReportedPose{};
  }
};

/// A camera with the robot that carries it.
class ScanSource {
 public:
  ScanSource() = default;
  ScanSource(const ScanSource&) = delete;
  ScanSource& operator=(const ScanSource&) = delete;
  virtual ~ScanSource() = default;

  [[nodiscard]] virtual hal::DepthCamera& camera() = 0;
  /// Called before each view, with the camera started: a frame taken from then on is of that view.
  virtual void await_view() {}
  /// Called before the pose at `stamp_ns` is asked for: waits until it can be known, but not long.
  virtual void await_report(std::int64_t /*stamp_ns*/) {}
  /// nullptr when nobody says where the camera was.
  [[nodiscard]] virtual hal::RobotState* robot_state() = 0;
  [[nodiscard]] virtual std::size_t num_views() const = 0;
  [[nodiscard]] virtual std::string description() const = 0;
};

/// Takes all views of the source, one frame each.
///
/// `T_flange_camera` makes camera poses of flange poses.
///
/// Errors:  throws Failure(kDevice) where the camera gives no frame or a damaged one, and
///          Failure(kUsage) where a flange pose comes without a hand-eye calibration.
[[nodiscard]] std::vector<ScannedView> take_views(
    ScanSource& source, const std::optional<geometry::RigidTransform>& T_flange_camera,
    const std::atomic<bool>& interrupted, Progress& progress);

}  // namespace dseam::program
