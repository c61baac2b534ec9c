// SPDX-License-Identifier: Apache-2.0
#include "support/accuracy/cell_rows.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "dseam/base/random.hpp"

namespace dseam::test {
namespace {

using hal::sim::CellConfig;
using hal::sim::JointKind;
using hal::sim::ShellKind;

constexpr double kDegree = std::numbers::pi / 180.0;

double between(Pcg32& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

/// A round nozzle on a cylinder: axes at 60 to 90 degrees, up to 20 mm off, gap 0 to 3 mm.
CellConfig any_cell(Pcg32& random) {
  CellConfig config;
  config.joint.shell_radius_mm = between(random, 95.0, 150.0);
  config.joint.nozzle_radius_mm = between(random, 38.0, 62.0);
  config.joint.shell_wall_mm = between(random, 6.0, 12.0);
  config.joint.nozzle_wall_mm = between(random, 4.0, 8.0);
  config.joint.nozzle_height_mm = between(random, 60.0, 95.0);
  config.joint.axis_angle_rad = between(random, 60.0, 90.0) * kDegree;
  config.joint.eccentricity_mm = between(random, -20.0, 20.0);
  config.joint.gap_mm = random.below(3) == 0 ? 0.0 : between(random, 1.0, 3.0);
  config.views.first_azimuth_rad = between(random, 0.0, 60.0) * kDegree;
  return config;
}

void oval(CellConfig& config, Pcg32& random) {
  config.joint.nozzle_ovality_mm = 0.3;
  config.joint.nozzle_ovality_angle_rad = between(random, 0.0, std::numbers::pi);
}

void cluttered(CellConfig& config) {
  config.clutter.num_clamps = 3;
  config.clutter.second_nozzle_radius_mm = 22.0;
  config.clutter.num_bolt_holes = 3;
  config.clutter.num_tack_welds = 4;
  config.clutter.num_spatter = 40;
  config.joint.shell_length_mm = 380.0;
  config.clutter.second_nozzle_x_mm = -145.0;
}

void open_joint(CellConfig& config, JointKind kind, Pcg32& random) {
  config.joint.kind = kind;
  config.joint.shell = ShellKind::kPlane;
  config.joint.shell_length_mm = between(random, 150.0, 220.0);
  config.joint.gap_mm = kind == JointKind::kButt ? between(random, 1.0, 3.0) : 0.0;
  config.views.count = 4;
  config.views.first_azimuth_rad = 45.0 * kDegree;
  config.views.azimuth_span_rad = 90.0 * kDegree;
}

/// The joint of the paper's published points.
hal::sim::JointConfig papers_joint() {
  hal::sim::JointConfig joint;
  joint.shell_radius_mm = 108.0;
  joint.nozzle_radius_mm = 59.2;
  joint.axis_angle_rad = 62.9 * kDegree;
  joint.eccentricity_mm = 1.4;
  joint.gap_mm = 0.0;
  return joint;
}

/// Two upright nozzles of one size side by side, both in view: nothing says which is meant.
void two_equal(CellConfig& config) {
  constexpr double kApartMm = 130.0;
  config.joint.axis_angle_rad = 90.0 * kDegree;
  config.joint.eccentricity_mm = 0.0;
  config.joint.gap_mm = 0.0;
  config.joint.nozzle_radius_mm = 40.0;
  config.joint.nozzle_height_mm = 60.0;
  config.joint.shell_length_mm = 520.0;
  config.clutter.second_nozzle_radius_mm = 40.0;
  config.clutter.second_nozzle_height_mm = 60.0;
  config.clutter.second_nozzle_x_mm = -kApartMm;
  config.views.aim_x_mm = -0.5 * kApartMm;
  config.views.working_distance_mm = 720.0;
}

struct Row {
  std::string_view name;
  void (*apply)(CellConfig&, Pcg32&);
};

constexpr std::array<Row, 23> kRows{{
    {"round", [](CellConfig&, Pcg32&) {}},
    {"touching", [](CellConfig& c, Pcg32&) { c.joint.gap_mm = 0.0; }},
    {"gap3", [](CellConfig& c, Pcg32&) { c.joint.gap_mm = 3.0; }},
    {"uneven_gap",
     [](CellConfig& c, Pcg32& r) {
       c.joint.gap_mm = 2.0;
       c.joint.hole_shift_x_mm = between(r, -0.7, 0.7);
       c.joint.hole_shift_y_mm = between(r, -0.7, 0.7);
     }},
    {"set_on", [](CellConfig& c, Pcg32&) { c.joint.kind = JointKind::kSetOn; }},
    {"oval", oval},
    {"oval_shell", [](CellConfig& c, Pcg32&) { c.joint.shell_ovality_mm = 0.3; }},
    {"cone", [](CellConfig& c, Pcg32& r) { c.joint.nozzle_taper_rad = between(r, 0.05, 0.2); }},
    {"plane", [](CellConfig& c, Pcg32&) { c.joint.shell = ShellKind::kPlane; }},
    {"sphere", [](CellConfig& c, Pcg32&) { c.joint.shell = ShellKind::kSphere; }},
    {"dead_band", [](CellConfig& c, Pcg32&) { c.scanner.dead_band_mm = 4.0; }},
    {"noise_0.1", [](CellConfig& c, Pcg32&) { c.scanner.noise_mm = 0.1; }},
    {"noise_0.3", [](CellConfig& c, Pcg32&) { c.scanner.noise_mm = 0.3; }},
    {"unseen",
     [](CellConfig& c, Pcg32& r) {
       c.scanner.unseen_share = 0.15;
       c.scanner.unseen_start = r.uniform();
     }},
    {"clutter", [](CellConfig& c, Pcg32&) { cluttered(c); }},
    {"paper", [](CellConfig& c, Pcg32&) { c.joint = papers_joint(); }},
    {"two_equal", [](CellConfig& c, Pcg32&) { two_equal(c); }},
    {"half_seen", [](CellConfig& c, Pcg32&) { c.scanner.unseen_share = 0.5; }},
    {"shell_only", [](CellConfig& c, Pcg32&) { c.joint.kind = JointKind::kShellOnly; }},
    {"no_markers", [](CellConfig& c, Pcg32&) { c.markers.count = 0; }},
    {"no_markers_oval",
     [](CellConfig& c, Pcg32& r) {
       c.markers.count = 0;
       oval(c, r);
     }},
    {"fillet", [](CellConfig& c, Pcg32& r) { open_joint(c, JointKind::kTFillet, r); }},
    {"butt", [](CellConfig& c, Pcg32& r) { open_joint(c, JointKind::kButt, r); }},
}};

constexpr auto kNames = [] {
  std::array<std::string_view, kRows.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    names[i] = kRows[i].name;
  }
  return names;
}();

}  // namespace

std::span<const std::string_view> cell_rows() noexcept { return kNames; }

std::optional<CellConfig> cell_of_row(std::string_view row, std::uint64_t seed) {
  constexpr int kMaxTries = 100;
  const auto found = std::ranges::find(kRows, row, &Row::name);
  if (found == kRows.end()) {
    return std::nullopt;
  }
  Pcg32 random(seed, static_cast<std::uint64_t>(found - kRows.begin()) + 100);
  for (int i = 0; i < kMaxTries; ++i) {
    CellConfig config = any_cell(random);
    config.seed = seed;
    found->apply(config, random);
    if (hal::sim::fault_in(config) == nullptr) {
      return config;
    }
  }
  return std::nullopt;
}

}  // namespace dseam::test
