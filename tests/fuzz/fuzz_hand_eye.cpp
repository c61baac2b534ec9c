// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdlib>
#include <string>

#include "failure.hpp"
#include "files/hand_eye_file.hpp"
#include "input/pose_pairs.hpp"

namespace {

bool usable(const dseam::geometry::RigidTransform& T) {
  return T.rotation.isUnitary(1e-4) && T.translation_mm.allFinite();
}

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

}  // namespace

/// Calibrations and pairs of poses: refused by name, or rigid.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    const auto hand_eye = dseam::program::parse_hand_eye(bytes, "hand_eye.json");
    require(usable(hand_eye.T_flange_camera) && hand_eye.expected_tool_mm >= 0.0);
  } catch (const dseam::program::Failure&) {  // A named refusal.
  }
  try {
    for (const auto& pair : dseam::program::parse_pairs(bytes, "pairs.json")) {
      require(usable(pair.T_base_flange) && usable(pair.T_camera_target));
    }
  } catch (const dseam::program::Failure&) {
  }
  return 0;
}
