// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "command/commands.hpp"
#include "dseam/calibration/hand_eye.hpp"
#include "files/hand_eye_file.hpp"
#include "files/output_folder.hpp"
#include "input/pose_pairs.hpp"
#include "report/text.hpp"
#include "scan/pose/marker_stations.hpp"

namespace dseam::program {
namespace {

std::string fault_of(const calibration::HandEye& result) {
  using calibration::HandEyeVerdict;
  switch (result.verdict) {
    case HandEyeVerdict::kGood:
    case HandEyeVerdict::kLargeResidual:
      return "";
    case HandEyeVerdict::kTooFewPoses:
      return "too few poses: at least three, better twelve";
    case HandEyeVerdict::kPosesTooSimilar:
      return "the poses are too similar: turn the flange by 25 degrees and more between them";
    case HandEyeVerdict::kParallelAxes:
      return "the flange turned about one axis only; turn it about another one too";
    case HandEyeVerdict::kFlangeReversed:
      return "the flange poses are the wrong way round (flange to base is meant)";
    case HandEyeVerdict::kTargetReversed:
      return "the target poses are the wrong way round (target to camera is meant)";
    case HandEyeVerdict::kWrongScale:
      return "the target's translations are off by a factor of " + fixed(result.scale, 4) +
             ": another unit, or a wrong pitch";
  }
  return calibration::name(result.verdict);
}

void print(const calibration::HandEye& result, const std::filesystem::path& file) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  std::cout << "residuals: " << fixed(result.rms_mm, 3) << " mm, "
            << fixed(result.rms_rad / kDegree, 4) << " degrees\n"
            << "expected error: " << fixed(result.expected_mm, 3) << " mm, "
            << fixed(result.expected_rad / kDegree, 4) << " degrees; at the tool "
            << fixed(result.expected_tool_mm, 3) << " mm\n"
            << "leaving one station out moves the tool by at most "
            << fixed(result.leave_one_out_mm, 3) << " mm (station " << result.worst_station
            << ")\n";
  if (result.verdict == calibration::HandEyeVerdict::kLargeResidual) {
    std::cout << "warning: the residuals are " << fixed(result.residual_ratio, 1)
              << " times the stated noise\n";
  }
  std::cout << "written: " << file.string() << '\n';
}

}  // namespace

ExitCode run_calibrate(const CalibrateOptions& options, const Invocation& invocation) {
  Settings settings;
  invocation.configure(settings);
  OutputFolder folder(options.out);
  const bool is_set = std::filesystem::is_directory(options.pairs);
  const std::vector<calibration::PosePair> pairs =
      is_set ? read_stations(options.pairs) : read_pairs(options.pairs);
  const auto result = calibration::calibrate_hand_eye(pairs, settings.hand_eye);
  if (!result.ok()) {
    throw Failure(ExitCode::kInput, options.pairs.string() + ": " + name(result.error()));
  }
  const std::string fault = fault_of(result.value());
  if (!fault.empty()) {
    throw Failure(ExitCode::kInput, options.pairs.string() + ": " + fault);
  }
  check_scale(result.value().T_flange_camera, options.pairs.string());
  folder.write("hand_eye.json",
               [&](std::ostream& out) { out << hand_eye_json(result.value()).dump(1) << '\n'; });
  folder.commit();
  print(result.value(), folder.path("hand_eye.json"));
  return ExitCode::kDone;
}

}  // namespace dseam::program
