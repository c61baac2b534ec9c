// SPDX-License-Identifier: Apache-2.0
// Where the camera sits on the flange, from stations that saw one fixed target; and that stations
// which cannot tell are refused by name.
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>

#include "dseam/calibration/hand_eye.hpp"

namespace {

using dseam::calibration::PosePair;
using dseam::geometry::RigidTransform;

RigidTransform pose(double x, double y, double z, double rx, double ry, double rz) {
  const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(rz, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(ry, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(rx, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  return {rotation, {x, y, z}};
}

}  // namespace

int main() {
  const RigidTransform T_flange_camera = pose(40.0, -10.0, 85.0, 0.02, -0.3, 1.57);
  const RigidTransform T_base_target = pose(700.0, 50.0, 20.0, 0.0, 0.0, 0.4);
  std::array<PosePair, 8> stations;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const double k = static_cast<double>(i);
    stations[i].T_base_flange =
        pose(600.0 + 20.0 * k, 30.0 * k - 100.0, 500.0, 3.0 + 0.3 * std::sin(2.0 * k),
             0.3 * std::cos(3.0 * k), 0.2 * k);
    stations[i].T_camera_target =
        (stations[i].T_base_flange * T_flange_camera).inverse() * T_base_target;
  }

  const auto all = dseam::calibration::calibrate_hand_eye(stations, {});
  const auto two = dseam::calibration::calibrate_hand_eye(std::span(stations).first(2), {});

  const double off_mm =
      (all.value().T_flange_camera.translation_mm - T_flange_camera.translation_mm).norm();
  std::printf("eight stations: %s, off by %.1e mm; two stations: %s\n", name(all.value().verdict),
              off_mm, name(two.value().verdict));
  return off_mm < 1e-6 ? 0 : 1;
}
