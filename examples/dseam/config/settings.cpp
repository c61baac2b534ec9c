// SPDX-License-Identifier: Apache-2.0
#include "config/settings.hpp"

namespace dseam::program {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::vector<Key> job_keys(Settings& s) {
  return {{"job", "method", choice(s.method, {"dseam", "paper"}),
           "The chain of stages: this project's, or the paper's in the paper's order"}};
}

std::vector<Key> seam_keys(pipeline::SeamChain::Config& c) {
  return {
      {"seam", "reference",
       choice(c.reference, {"shell_edge", "root", "gap_middle", "nozzle_edge"}),
       "Which curve of the joint is the seam"},
      {"seam", "min_coverage", &c.min_coverage, "Refused when less of the ring was seen", "", 0, 1},
      {"seam", "max_hole_rad", &c.max_hole_rad, "Refused when a longer stretch was not seen", "rad",
       0, 2 * kPi},
      {"seam", "max_sigma_mm", &c.max_sigma_mm, "Refused when the seam is known less well", "mm",
       0.001, 100},
      {"seam", "point_spacing_mm", &c.point_spacing_mm, "Distance of the points of seam.csv", "mm",
       0.05, 10},
      {"seam", "start_angle_rad", &c.start_angle_rad,
       "Where the seam starts, about the nozzle's axis, from base x", "rad", -2 * kPi, 2 * kPi},
      {"seam", "counter_clockwise", &c.counter_clockwise,
       "Direction of travel, seen from the nozzle's free end"},
      {"seam", "hand_eye_sigma_mm", &c.hand_eye_sigma_mm,
       "Error of the hand-eye calibration at the seam; 0 when it is not known", "mm", 0, 100},
  };
}

}  // namespace

std::vector<Key> keys_of(Settings& settings) {
  std::vector<Key> keys;
  for (const std::vector<Key>& part : {job_keys(settings), seam_keys(settings.seam)}) {
    keys.insert(keys.end(), part.begin(), part.end());
  }
  return keys;
}

}  // namespace dseam::program
