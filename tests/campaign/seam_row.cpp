// SPDX-License-Identifier: Apache-2.0
#include "campaign/seam_row.hpp"

#include <numbers>

#include "dseam/base/random.hpp"
#include "dseam/hal/sim/cell.hpp"

namespace dseam::campaign {
namespace {

using hal::sim::CellConfig;
using hal::sim::JointKind;
using hal::sim::ShellKind;

constexpr double kDegree = std::numbers::pi / 180.0;
// Under a nozzle that leans by 30 degrees, cameras at 45 see nothing of it but straight from ahead.
constexpr double kTiltRad = 57.0 * kDegree;

void nothing(CellConfig&) {}
void touching(CellConfig& c) { c.joint.gap_mm = 0.0; }
void gap_1(CellConfig& c) { c.joint.gap_mm = 1.0; }
void gap_3(CellConfig& c) { c.joint.gap_mm = 3.0; }
void gap_varies(CellConfig& c) {
  c.joint.hole_shift_x_mm = 0.7;
  c.joint.hole_shift_y_mm = -0.5;
}
void set_on(CellConfig& c) {
  c.joint.kind = JointKind::kSetOn;
  c.joint.gap_mm = 0.0;
}
void oval(CellConfig& c) {
  c.joint.nozzle_ovality_mm = 0.3;
  c.joint.shell_ovality_mm = 0.3;
}
void dead_band(CellConfig& c) {
  c.joint.gap_mm = 0.0;
  c.scanner.dead_band_mm = 4.0;
}
void noise_0_1(CellConfig& c) { c.scanner.noise_mm = 0.1; }
void noise_0_3(CellConfig& c) { c.scanner.noise_mm = 0.3; }
void plane(CellConfig& c) { c.joint.shell = ShellKind::kPlane; }
void sphere(CellConfig& c) {
  c.joint.shell = ShellKind::kSphere;
  c.joint.shell_radius_mm = 250.0;
}
void unseen(CellConfig& c) { c.scanner.unseen_share = 0.15; }
void clutter(CellConfig& c) {
  c.clutter.num_clamps = 2;
  c.clutter.second_nozzle_radius_mm = 22.0;
  c.clutter.num_bolt_holes = 4;
  c.clutter.num_spatter = 20;
}
void tacks(CellConfig& c) {
  c.joint.gap_mm = 0.0;
  c.clutter.num_tack_welds = 4;
  c.clutter.num_spatter = 20;
}
void cone(CellConfig& c) { c.joint.nozzle_taper_rad = 4.0 * kDegree; }
void half_seen(CellConfig& c) { c.scanner.unseen_share = 0.5; }
void no_nozzle(CellConfig& c) { c.joint.kind = JointKind::kShellOnly; }

}  // namespace

// What differs from seed to seed in every row.
CellConfig cell_of(const Row& row, std::uint64_t seed) {
  Pcg32 random(seed, 77);
  CellConfig config;
  config.seed = seed;
  config.joint.axis_angle_rad = (60.0 + 30.0 * random.uniform()) * kDegree;
  config.joint.eccentricity_mm = 40.0 * random.uniform() - 20.0;
  config.joint.nozzle_radius_mm = 45.0 + 20.0 * random.uniform();
  config.joint.nozzle_ovality_angle_rad = 3.0 * random.uniform();
  config.views.first_azimuth_rad = 6.0 * random.uniform();
  config.views.tilt_rad = kTiltRad;
  config.scanner.unseen_start = random.uniform();
  row.change(config);
  if (config.joint.shell == ShellKind::kPlane) {
    config.joint.eccentricity_mm = 0.0;
  }
  return config;
}

const std::array<Row, 22> kRows = {{
    {"gap 2", nothing, Poses::kTrue, 0.03, 0.08, 0.99},
    {"gap 1", gap_1, Poses::kTrue, 0.03, 0.08, 0.99},
    {"gap 3", gap_3, Poses::kTrue, 0.03, 0.08, 0.99},
    {"gap varies", gap_varies, Poses::kTrue, 0.03, 0.08, 0.99},
    {"touching", touching, Poses::kTrue, 0.03, 0.08, 0.99},
    {"set on", set_on, Poses::kTrue, 0.03, 0.08, 0.99},
    {"oval", oval, Poses::kTrue, 0.06, 0.2, 0.99},
    {"dead band", dead_band, Poses::kTrue, 0.1, 0.3, 0.99},
    {"noise 0.1", noise_0_1, Poses::kTrue, 0.08, 1.0, 0.99},
    {"noise 0.3", noise_0_3, Poses::kTrue, 0.2, 1.0, 0.99},
    {"plane", plane, Poses::kTrue, 0.05, 0.15, 0.99},
    {"sphere", sphere, Poses::kTrue, 0.05, 0.15, 0.99},
    {"unseen 15", unseen, Poses::kTrue, 0.05, 0.15, 0.82},
    {"clutter", clutter, Poses::kTrue, 0.08, 0.5, 0.95},
    {"tacks", tacks, Poses::kTrue, 0.08, 0.5, 0.8},
    {"cone", cone, Poses::kTrue, 0.05, 0.15, 0.99},
    {"spliced gap 2", nothing, Poses::kSpliced, 0.05, 0.15, 0.99},
    {"spliced touching", touching, Poses::kSpliced, 0.05, 0.15, 0.99},
    {"spliced oval", oval, Poses::kSpliced, 0.06, 0.2, 0.99},
    {"spliced clutter", clutter, Poses::kSpliced, 0.08, 0.5, 0.95},
    {"half seen", half_seen, Poses::kTrue, 0.0, 0.0, 0.0},
    {"no nozzle", no_nozzle, Poses::kTrue, 0.0, 0.0, 0.0},
}};

}  // namespace dseam::campaign
