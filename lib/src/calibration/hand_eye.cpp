// SPDX-License-Identifier: Apache-2.0
#include "dseam/calibration/hand_eye.hpp"

#include <cmath>

#include "calibration/stations.hpp"

namespace dseam::calibration {
namespace {

using geometry::Matrix6;
using geometry::RigidTransform;

constexpr int kMaxIterations = 20;
constexpr int kLeaveOneOutIterations = 4;

bool usable(std::span<const PosePair> stations, const HandEyeConfig& config) noexcept {
  const bool sigmas = config.flange_sigma_mm > 0.0 && config.flange_sigma_rad > 0.0 &&
                      config.target_sigma_mm > 0.0 && config.target_sigma_rad > 0.0;
  bool finite = true;
  for (const PosePair& s : stations) {
    finite = finite && s.T_base_flange.rotation.allFinite() &&
             s.T_base_flange.translation_mm.allFinite() && s.T_camera_target.rotation.allFinite() &&
             s.T_camera_target.translation_mm.allFinite();
  }
  return sigmas && finite && stations.size() <= kMaxPosePairs;
}

HandEyeVerdict judge_geometry(const Stations& stations, const HandEyeConfig& config) noexcept {
  if (stations.size() < 3) {
    return HandEyeVerdict::kTooFewPoses;
  }
  const TurnSpread spread = turn_spread(stations);
  if (spread.first_rad < config.min_spread_rad) {
    return HandEyeVerdict::kPosesTooSimilar;
  }
  return spread.second_rad < config.min_spread_rad ? HandEyeVerdict::kParallelAxes
                                                   : HandEyeVerdict::kGood;
}

double residual_ratio(const Adjusted& adjusted, std::size_t num_stations) noexcept {
  const double freedom = 6.0 * static_cast<double>(num_stations) - 12.0;
  return std::sqrt(adjusted.chi_square / freedom);
}

/// The same problem with one kind of pose inverted: how large are the residuals then?
double ratio_when(const Stations& stations, const HandEyeConfig& config) noexcept {
  const Adjusted other = adjust(stations, closed_form(stations), config, kMaxIterations);
  return residual_ratio(other, stations.size());
}

bool scale_is_wrong(const HandEye& hand_eye) noexcept {
  constexpr double kSigmas = 4.0;
  constexpr double kTolerance = 0.005;
  const double off = std::abs(hand_eye.scale - 1.0);
  return off > kTolerance && off > kSigmas * hand_eye.scale_sigma;
}

/// Why the residuals are larger than noise, where a common mistake explains them.
HandEyeVerdict explain(const Stations& stations, const HandEyeConfig& config,
                       const HandEye& hand_eye) noexcept {
  constexpr double kOfNoise = 2.0;
  constexpr double kClearlyBetter = 0.2;
  if (hand_eye.residual_ratio <= kOfNoise) {
    return HandEyeVerdict::kGood;
  }
  const double flange = ratio_when(stations.with_flange_inverted(), config);
  const double target = ratio_when(stations.with_target_inverted(), config);
  if (std::fmin(flange, target) < kClearlyBetter * hand_eye.residual_ratio) {
    return flange < target ? HandEyeVerdict::kFlangeReversed : HandEyeVerdict::kTargetReversed;
  }
  if (scale_is_wrong(hand_eye)) {
    return HandEyeVerdict::kWrongScale;
  }
  return hand_eye.residual_ratio > config.max_residual_ratio ? HandEyeVerdict::kLargeResidual
                                                             : HandEyeVerdict::kGood;
}

void state_residuals(const Stations& stations, const Loop& loop, HandEye& out) noexcept {
  double shift = 0.0;
  double turn = 0.0;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const geometry::Vector6 r = misclosure(stations[i], loop);
    shift += r.head<3>().squaredNorm();
    turn += r.tail<3>().squaredNorm();
  }
  const auto n = static_cast<double>(stations.size());
  out.rms_mm = std::sqrt(shift / n);
  out.rms_rad = std::sqrt(turn / n);
}

/// Expected length of the error of the point p_flange that the camera reports.
double expected_shift_mm(const Matrix6& covariance, const Eigen::Vector3d& p_flange) noexcept {
  Eigen::Matrix<double, 3, 6> j;
  j << Eigen::Matrix3d::Identity(), -geometry::skew(p_flange);
  return std::sqrt((j * covariance * j.transpose()).trace());
}

void state_expected_errors(const HandEyeConfig& config, HandEye& out) noexcept {
  const Eigen::Vector3d p_work_camera(0.0, 0.0, config.working_distance_mm);
  out.expected_mm = expected_shift_mm(out.covariance, out.T_flange_camera.translation_mm);
  out.expected_rad = std::sqrt(out.covariance.bottomRightCorner<3, 3>().trace());
  out.expected_tool_mm = expected_shift_mm(out.covariance, out.T_flange_camera * p_work_camera);
}

void leave_one_out(const Stations& stations, const Loop& loop, const HandEyeConfig& config,
                   HandEye& out) noexcept {
  const Eigen::Vector3d p_work_camera(0.0, 0.0, config.working_distance_mm);
  for (std::size_t i = 0; stations.size() > 3 && i < stations.size(); ++i) {
    const Adjusted fewer = adjust(stations.without(i), loop, config, kLeaveOneOutIterations);
    const double moved_mm =
        (fewer.loop.T_flange_camera * p_work_camera - out.T_flange_camera * p_work_camera).norm();
    if (moved_mm > out.leave_one_out_mm) {
      out.leave_one_out_mm = moved_mm;
      out.worst_station = static_cast<std::uint32_t>(i);
    }
  }
}

}  // namespace

const char* name(HandEyeVerdict verdict) noexcept {
  constexpr const char* kNames[] = {"Good",         "TooFewPoses",    "PosesTooSimilar",
                                    "ParallelAxes", "FlangeReversed", "TargetReversed",
                                    "WrongScale",   "LargeResidual"};
  return kNames[static_cast<std::uint8_t>(verdict)];
}

Result<HandEye> calibrate_hand_eye(std::span<const PosePair> pairs,
                                   const HandEyeConfig& config) noexcept {
  if (!usable(pairs, config)) {
    return Errc::kInvalidArgument;
  }
  const Stations stations(pairs);
  HandEye out;
  out.verdict = judge_geometry(stations, config);
  if (out.verdict != HandEyeVerdict::kGood) {
    return out;
  }
  const Loop start = closed_form(stations);
  const Adjusted adjusted = adjust(stations, start, config, kMaxIterations);
  out.T_flange_camera = adjusted.loop.T_flange_camera;
  out.T_base_target = adjusted.loop.T_base_target;
  out.residual_ratio = residual_ratio(adjusted, stations.size());
  out.covariance = adjusted.covariance * (out.residual_ratio * out.residual_ratio);
  // From the start's rotation, which a wrong scale has not touched.
  const ScaleGuess guess = target_scale(stations, start.T_flange_camera.rotation);
  out.scale = guess.scale;
  out.scale_sigma = guess.sigma;
  state_residuals(stations, adjusted.loop, out);
  state_expected_errors(config, out);
  leave_one_out(stations, adjusted.loop, config, out);
  out.verdict = explain(stations, config, out);
  return out;
}

}  // namespace dseam::calibration
