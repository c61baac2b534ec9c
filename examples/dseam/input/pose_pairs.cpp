// SPDX-License-Identifier: Apache-2.0
#include "input/pose_pairs.hpp"

#include "failure.hpp"
#include "input/cloud_reader.hpp"
#include "input/json_reader.hpp"

namespace dseam::program {

std::vector<calibration::PosePair> read_pairs(const std::filesystem::path& file) {
  return parse_pairs(read_bytes(file), file.string());
}

std::vector<calibration::PosePair> parse_pairs(const std::string& bytes, const std::string& name) {
  const nlohmann::json content = parse_json(bytes, name);
  if (!content.is_array() && !content.is_object()) {
    throw Failure(ExitCode::kInput, name + ": neither a list nor an object of pairs");
  }
  std::vector<calibration::PosePair> pairs;
  for (const nlohmann::json& pair : content) {
    const std::string where = name + ": pair " + std::to_string(pairs.size());
    pairs.push_back(
        {rigid_at(pair, "T_base_flange", where), rigid_at(pair, "T_camera_target", where)});
  }
  if (pairs.size() > calibration::kMaxPosePairs) {
    throw Failure(ExitCode::kInput, name + ": " + std::to_string(pairs.size()) +
                                        " pairs; at most " +
                                        std::to_string(calibration::kMaxPosePairs));
  }
  return pairs;
}

}  // namespace dseam::program
