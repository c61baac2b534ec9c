// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/seam_report.hpp"

namespace dseam::seam {

const char* name(Refusal refusal) noexcept {
  constexpr const char* kNames[] = {"None",        "EmptyCloud", "NotMillimetres",  "Coplanar",
                                    "OneSurface",  "NoRing",     "OutsideRegion",   "TwoRings",
                                    "LowCoverage", "LargeHole",  "NoSuchReference", "Uncertain",
                                    "Full",        "NoSeam",     "TwoSeams"};
  return kNames[static_cast<std::uint8_t>(refusal)];
}

const char* name(SurfaceKind kind) noexcept {
  constexpr const char* kNames[] = {"Plane", "Sphere", "Cylinder", "Cone"};
  return kNames[static_cast<std::uint8_t>(kind)];
}

const char* name(RingFate fate) noexcept {
  constexpr const char* kNames[] = {"Chosen",      "Outscored",     "Equal",      "Convex",
                                    "Unsupported", "OutsideRegion", "WrongRadius"};
  return kNames[static_cast<std::uint8_t>(fate)];
}

bool is_fault_of_input(Refusal refusal) noexcept {
  switch (refusal) {
    case Refusal::kEmptyCloud:
    case Refusal::kNotMillimetres:
    case Refusal::kCoplanar:
    case Refusal::kOneSurface:
    case Refusal::kNoRing:
    case Refusal::kOutsideRegion:
    case Refusal::kNoSuchReference:
    case Refusal::kFull:
    case Refusal::kNoSeam:
      return true;
    default:
      return false;
  }
}

}  // namespace dseam::seam
