// SPDX-License-Identifier: Apache-2.0
#include "config/settings.hpp"

#include <algorithm>

#include "config/key_tables.hpp"

namespace dseam::program {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kWideMm = 1.0e6;

std::vector<Key> job_keys(Settings& s) {
  return {
      {"job", "method", choice(s.method, {"dseam", "paper"}),
       "The chain of stages: this project's, or the paper's in the paper's order"},
      {"job", "max_points", &s.max_points, "More points in the clouds of a command are refused",
       "points", 1000, 16e6},
      {"job", "max_voxels", &s.max_voxels, "Room for the voxels of a scan", "voxels", 1000, 64e6},
      {"job", "max_seam_points", &s.max_seam_points, "Room for the points of seam.csv", "points",
       64, 1e6}};
}

std::vector<Key> seam_keys(Settings& s) {
  pipeline::SeamChain::Config& c = s.seam;
  return {
      {"seam", "kind", choice(s.shape, {"closed", "open"}),
       "A ring round a nozzle, or the open line between two plates (extract)"},
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

void add_box_keys(const std::string& prefix, const std::string& what, cloud::OrientedBox& box,
                  std::vector<Key>& keys) {
  const auto add = [&](const char* end, float* mm) {
    keys.push_back({"paper", prefix + end, mm, what, "mm", -kWideMm, kWideMm});
  };
  add("_min_x_mm", &box.low_mm.x);
  add("_max_x_mm", &box.high_mm.x);
  add("_min_y_mm", &box.low_mm.y);
  add("_max_y_mm", &box.high_mm.y);
  add("_min_z_mm", &box.low_mm.z);
  add("_max_z_mm", &box.high_mm.z);
}

std::vector<Key> paper_keys(pipeline::PaperPipeline::Config& c) {
  std::vector<Key> keys = {
      {"paper", "num_neighbours", &c.outliers.num_neighbours, "K of equation 2", "", 1, 64},
      {"paper", "alpha", &c.outliers.alpha, "Sigmas over the mean from which on equation 5 drops",
       "", -10, 100},
      {"paper", "cell_mm", &c.cell_mm, "Edge of the voxels", "mm", 0.1, 100},
      {"paper", "radius_mm", &c.radius_mm, "Of the neighbours for normals and boundary", "mm", 0.1,
       100},
      {"paper", "min_gap_rad", &c.min_gap_rad,
       "A larger angle without a neighbour makes a boundary point", "rad", 0.1, 2 * kPi},
  };
  add_box_keys("pass", "Passthrough: points beyond are dropped", c.passthrough, keys);
  add_box_keys("seam", "Constraints: boundary points beyond are not the seam", c.constraints, keys);
  return keys;
}

/// Which ring is meant where several are found.
std::vector<Key> choice_keys(RingChoice& c) {
  std::vector<Key> keys = {{"seam", "expected_radius_mm", &c.expected_radius_mm,
                            "Of the nozzle that is meant; 0: any", "mm", 0, 10000}};
  const std::string axes[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) {
    keys.push_back({"seam", "region_min_" + axes[i] + "_mm", &c.region_min_mm[i],
                    "Rings beyond are not meant", "mm", -kWideMm, kWideMm});
    keys.push_back({"seam", "region_max_" + axes[i] + "_mm", &c.region_max_mm[i],
                    "Rings beyond are not meant", "mm", -kWideMm, kWideMm});
  }
  return keys;
}

/// What decides every predicted sigma; the defaults are those of the simulated cell's devices.
std::vector<Key> scanner_keys(Settings& s) {
  splice::ViewNetwork::Config& network = s.pipeline.splice.network;
  markers::MarkerFinder::Config& finder = s.pipeline.splice.finder;
  return {
      {"scanner", "sigma_mm", &s.seam.scanner_sigma_mm,
       "Error of depth that its calibration leaves, the same in all views", "mm", 0, 10},
      {"scanner", "bowl_sigma_mm", &network.bowl_sigma_mm,
       "Of a depth bowl at the sides of the image", "mm", 0.0001, 10},
      {"scanner", "offset_sigma_mm", &network.offset_sigma_mm,
       "Of an error that all depths have in common", "mm", 0.0001, 10},
      {"scanner", "depth_sigma_mm", &finder.sigma_depth_mm,
       "Of one depth, the share that neighbours have in common", "mm", 0.0001, 10},
      {"scanner", "robot_sigma_mm", &network.reported_sigma_mm,
       "Of a reported camera position, each axis", "mm", 0.001, 100},
      {"scanner", "robot_sigma_rad", &network.reported_sigma_rad,
       "Of a reported camera orientation, each axis", "rad", 1e-6, 0.5},
      {"scanner", "min_marker_radius_mm", &finder.min_radius_mm, "Smaller discs are no markers",
       "mm", 0.2, 100},
      {"scanner", "max_marker_radius_mm", &finder.max_radius_mm, "Larger discs are no markers",
       "mm", 0.2, 100},
  };
}

std::vector<Key> map_keys(pipeline::WeldPipeline::Config& c) {
  return {
      {"map", "coarse_cell_mm", &c.coarse_cell_mm, "Cells in which the seam is first sought", "mm",
       0.1, 50},
      {"map", "fine_cell_mm", &c.fine_cell_mm, "Cells around the seam", "mm", 0.1, 20},
      {"map", "region_margin_mm", &c.region_margin_mm, "Kept around the seam that was first found",
       "mm", 5, 1000},
      {"map", "flying_step_mm", &c.flying_step_mm,
       "A pixel this far from its neighbours mixes two surfaces", "mm", 0.1, 100},
  };
}

std::vector<Key> hand_eye_keys(calibration::HandEyeConfig& c) {
  return {
      {"hand_eye", "flange_sigma_mm", &c.flange_sigma_mm, "Noise of the robot's reported position",
       "mm", 1e-6, 10},
      {"hand_eye", "flange_sigma_rad", &c.flange_sigma_rad,
       "Noise of the robot's reported orientation", "rad", 1e-8, 0.1},
      {"hand_eye", "target_sigma_mm", &c.target_sigma_mm, "Noise of the target's measured position",
       "mm", 1e-6, 10},
      {"hand_eye", "target_sigma_rad", &c.target_sigma_rad,
       "Noise of the target's measured orientation", "rad", 1e-8, 0.1},
      {"hand_eye", "min_spread_rad", &c.min_spread_rad,
       "Refused when the flange turned less about its second axis", "rad", 0, kPi},
      {"hand_eye", "max_residual_ratio", &c.max_residual_ratio,
       "Residuals over the stated noise from which on it warns", "", 1, 1e6},
      {"hand_eye", "working_distance_mm", &c.working_distance_mm,
       "From the camera to the work, where the expected error is stated", "mm", 1, 10000},
  };
}

}  // namespace

pipeline::PaperPipeline::Config unconstrained_paper() {
  constexpr auto kWide = static_cast<float>(kWideMm);
  pipeline::PaperPipeline::Config config;
  for (cloud::OrientedBox* box : {&config.passthrough, &config.constraints}) {
    box->low_mm = {-kWide, -kWide, -kWide};
    box->high_mm = {kWide, kWide, kWide};
  }
  return config;
}

std::optional<pipeline::RegionOfInterest> RingChoice::region() const {
  if (std::all_of(region_min_mm.begin(), region_min_mm.end(),
                  [](double v) { return v <= -kWideMm; }) &&
      std::all_of(region_max_mm.begin(), region_max_mm.end(),
                  [](double v) { return v >= kWideMm; })) {
    return std::nullopt;
  }
  return pipeline::RegionOfInterest{Eigen::Vector3d(region_min_mm.data()),
                                    Eigen::Vector3d(region_max_mm.data())};
}

std::optional<double> RingChoice::radius_mm() const {
  return expected_radius_mm > 0.0 ? std::optional(expected_radius_mm) : std::nullopt;
}

void append(std::vector<Key>& keys, const std::vector<Key>& more) {
  keys.insert(keys.end(), more.begin(), more.end());
}

std::vector<Key> keys_of(Settings& settings) {
  std::vector<Key> keys = job_keys(settings);
  append(keys, map_keys(settings.pipeline));
  append(keys, seam_keys(settings));
  append(keys, choice_keys(settings.ring));
  append(keys, paper_keys(settings.paper));
  append(keys, scanner_keys(settings));
  append(keys, motion_keys(settings.motion));
  append(keys, session_keys(settings.session));
  append(keys, hand_eye_keys(settings.hand_eye));
  append(keys, camera_keys(settings.camera));
  append(keys, cell_keys(settings.cell));
  return keys;
}

}  // namespace dseam::program
