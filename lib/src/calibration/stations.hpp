// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "dseam/calibration/hand_eye.hpp"

namespace dseam::calibration {

/// The stations as the solver sees them: poses inverted or one left out, without a copy.
class Stations {
 public:
  explicit Stations(std::span<const PosePair> pairs) : pairs_(pairs), left_out_(pairs.size()) {}

  [[nodiscard]] Stations without(std::size_t i) const {
    Stations fewer = *this;
    fewer.left_out_ = i;
    return fewer;
  }
  [[nodiscard]] Stations with_flange_inverted() const {
    Stations other = *this;
    other.invert_flange_ = true;
    return other;
  }
  [[nodiscard]] Stations with_target_inverted() const {
    Stations other = *this;
    other.invert_target_ = true;
    return other;
  }

  [[nodiscard]] std::size_t size() const {
    return pairs_.size() - (left_out_ < pairs_.size() ? 1U : 0U);
  }
  [[nodiscard]] PosePair operator[](std::size_t i) const {
    const PosePair& pair = pairs_[i < left_out_ ? i : i + 1];
    return {invert_flange_ ? pair.T_base_flange.inverse() : pair.T_base_flange,
            invert_target_ ? pair.T_camera_target.inverse() : pair.T_camera_target};
  }

 private:
  std::span<const PosePair> pairs_;
  std::size_t left_out_;
  bool invert_flange_ = false;
  bool invert_target_ = false;
};

/// The two unknown transforms: A_i X B_i = W at every station.
struct Loop {
  geometry::RigidTransform T_flange_camera;
  geometry::RigidTransform T_base_target;
};

/// How far the robot turned between stations, about its most and second most used axis.
struct TurnSpread {
  double first_rad = 0.0;
  double second_rad = 0.0;
};

/// A guess of the target's scale from the linear part of the problem.
struct ScaleGuess {
  double scale = 1.0;
  double sigma = 0.0;
};

/// What the weighted adjustment ends with.
struct Adjusted {
  Loop loop;
  geometry::Matrix6 covariance;  ///< Of T_flange_camera, for the stated noise.
  double chi_square = 0.0;
};

[[nodiscard]] TurnSpread turn_spread(const Stations& stations) noexcept;
[[nodiscard]] Loop closed_form(const Stations& stations) noexcept;
[[nodiscard]] ScaleGuess target_scale(const Stations& stations,
                                      const Eigen::Matrix3d& R_flange_camera) noexcept;
[[nodiscard]] Adjusted adjust(const Stations& stations, const Loop& start,
                              const HandEyeConfig& config, int max_iterations) noexcept;
/// Target's deviation from its mean pose at one station: (mm, rad), without weights.
[[nodiscard]] geometry::Vector6 misclosure(const PosePair& station, const Loop& loop) noexcept;

}  // namespace dseam::calibration
