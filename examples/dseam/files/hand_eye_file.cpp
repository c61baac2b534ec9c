// SPDX-License-Identifier: Apache-2.0
#include "files/hand_eye_file.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>
#include <span>

#include "dseam/link/crc.hpp"
#include "failure.hpp"
#include "input/cloud_reader.hpp"
#include "input/json_reader.hpp"

namespace dseam::program {
namespace {

using Json = nlohmann::ordered_json;

// A camera on a flange is some hundredths of a metre away from its centre at least.
constexpr double kNearestMm = 2.0;

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts = {};
  gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return {text.data(), size};
}

/// CRC-32 over the compact text without the checksum, keys in the order of the alphabet.
std::string checksum_of(nlohmann::json content) {
  content.erase("checksum");
  const std::string text = content.dump();
  std::array<char, 16> digits{};
  const int size = std::snprintf(digits.data(), digits.size(), "%08x",
                                 link::crc32(std::as_bytes(std::span(text))));
  return {digits.data(), static_cast<std::size_t>(size)};
}

}  // namespace

Json hand_eye_json(const calibration::HandEye& calibrated) {
  Json file = {
      {"T_flange_camera", geometry::to_row_major(calibrated.T_flange_camera)},
      {"covariance", std::span<const double>(calibrated.covariance.data(), 36)},
      {"units", {{"length", "mm"}, {"angle", "rad"}}},
      {"date", utc_now()},
      {"residuals",
       {{"rms_mm", calibrated.rms_mm},
        {"rms_rad", calibrated.rms_rad},
        {"ratio_to_noise", calibrated.residual_ratio}}},
      {"expected_error",
       {{"position_mm", calibrated.expected_mm},
        {"rotation_rad", calibrated.expected_rad},
        {"tool_mm", calibrated.expected_tool_mm}}},
      {"leave_one_out",
       {{"tool_mm", calibrated.leave_one_out_mm}, {"worst_station", calibrated.worst_station}}},
      {"verdict", calibration::name(calibrated.verdict)}};
  file["checksum"] = checksum_of(nlohmann::json::parse(file.dump()));
  return file;
}

namespace {

/// What stands under `key`, or an empty object where that is none.
nlohmann::json object_at(const nlohmann::json& content, const char* key) {
  return content.contains(key) && content[key].is_object() ? content[key]
                                                           : nlohmann::json::object();
}

bool is_unit(const nlohmann::json& units, const char* of, const char* unit) {
  return units.contains(of) && units[of] == unit;
}

}  // namespace

void check_scale(const geometry::RigidTransform& T_flange_camera, const std::string& where) {
  if (T_flange_camera.translation_mm.norm() < kNearestMm) {
    throw Failure(ExitCode::kInput,
                  where + ": the camera lies within 2 mm of the flange's centre: in metres?");
  }
}

HandEyeFile read_hand_eye(const std::filesystem::path& file) {
  return parse_hand_eye(read_bytes(file), file.string());
}

HandEyeFile parse_hand_eye(const std::string& bytes, const std::string& name) {
  const nlohmann::json content = parse_json(bytes, name);
  const auto fail = [&name](const char* fault) {
    throw Failure(ExitCode::kInput, name + ": " + fault);
  };
  if (!content.is_object() || !content.contains("checksum") ||
      content["checksum"] != checksum_of(content)) {
    fail("damaged: its checksum does not match");
  }
  const nlohmann::json units = object_at(content, "units");
  if (!is_unit(units, "length", "mm") || !is_unit(units, "angle", "rad")) {
    fail("its units are not mm and rad");
  }
  const nlohmann::json expected = object_at(content, "expected_error");
  if (!expected.contains("tool_mm") || !expected["tool_mm"].is_number() ||
      expected["tool_mm"].get<double>() < 0.0) {
    fail("no expected_error.tool_mm");
  }
  const HandEyeFile file{rigid_at(content, "T_flange_camera", name),
                         expected["tool_mm"].get<double>()};
  check_scale(file.T_flange_camera, name);
  return file;
}

}  // namespace dseam::program
