// SPDX-License-Identifier: Apache-2.0
// Input that can be read, of a part that is not to be welded: docs/formats.md, "Bad input".
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <sstream>

#include "program/support/run_program.hpp"
#include "support/shapes/joint_cloud.hpp"

namespace dseam::program {
namespace {

using dseam::test::JointCloud;
using dseam::test::JointCloudConfig;
using test::Outcome;
using test::run_program;
using Names = std::set<std::string>;

const Names kReports{"report.html", "report.json"};
const Names kNoCurve{"merged.ply", "report.html", "report.json"};
const Names kWithCurve{"merged.ply", "report.html", "report.json", "seam.csv"};

Names reports_and(Names more) {
  more.insert(kReports.begin(), kReports.end());
  return more;
}

std::string ply_of(const cloud::CloudView& cloud, double mm_per_unit) {
  std::ostringstream text;
  text << "ply\nformat ascii 1.0\nelement vertex " << cloud.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    text << double{cloud.x[i]} / mm_per_unit << ' ' << double{cloud.y[i]} / mm_per_unit << ' '
         << double{cloud.z[i]} / mm_per_unit << '\n';
  }
  return text.str();
}

/// A nozzle of 40 mm radius, coarse enough to be read fast.
JointCloudConfig small_joint() {
  JointCloudConfig config;
  config.nozzle_radius_mm = 40.0;
  config.shell_reach_mm = 40.0;
  config.nozzle_height_mm = 40.0;
  config.spacing_mm = 1.5;
  return config;
}

nlohmann::json report_in(const test::ScratchFolder& scratch) {
  std::ifstream in(scratch.path("out/report.json"));
  return nlohmann::json::parse(in);
}

/// A part that is refused, by what name, and what the program says and leaves.
struct RefusedPart {
  const char* name;
  void (*change)(JointCloudConfig& config);
  std::vector<std::string> options;
  int exit_code;
  const char* refusal;
  const char* reason;
  Names files;
  double mm_per_unit = 1.0;
};

void PrintTo(const RefusedPart& part, std::ostream* out) { *out << part.name; }

class RefusedPartTest : public ::testing::TestWithParam<RefusedPart> {};

TEST_P(RefusedPartTest, is_told_with_its_reason_and_leaves_what_the_table_says) {
  const RefusedPart& part = GetParam();
  const test::ScratchFolder scratch;
  JointCloudConfig config = small_joint();
  part.change(config);
  const JointCloud cloud(config);
  std::vector<std::string> words{
      "extract", scratch.write("part.ply", ply_of(cloud.view().points, part.mm_per_unit)), "--out",
      scratch.path("out")};
  words.insert(words.end(), part.options.begin(), part.options.end());

  const Outcome outcome = run_program(words);

  EXPECT_EQ(outcome.exit_code, part.exit_code) << outcome.text;
  EXPECT_NE(outcome.text.find(part.reason), std::string::npos) << outcome.text;
  ASSERT_EQ(scratch.names_in("out"), part.files);
  EXPECT_EQ(report_in(scratch)["seam"]["refusal"], part.refusal);
  EXPECT_EQ(report_in(scratch)["verdict"]["weld"], false);
}

void shell_alone(JointCloudConfig& config) { config.nozzle = false; }
void plate_alone(JointCloudConfig& config) {
  config.nozzle = false;
  config.shell = JointCloudConfig::Shell::kPlane;
  config.noise_mm = 0.0;
}
void as_it_is(JointCloudConfig&) {}
void half_unseen(JointCloudConfig& config) { config.unseen_width_rad = 2.5; }
void sector_unseen(JointCloudConfig& config) { config.unseen_width_rad = 1.15; }
void nozzle_alone(JointCloudConfig& config) { config.shell_seen = false; }

using Words = std::vector<std::string>;
INSTANTIATE_TEST_SUITE_P(
    Parts, RefusedPartTest,
    ::testing::Values(
        RefusedPart{"one_plane", plate_alone, {}, 3, "Coplanar", "in one plane", kNoCurve},
        RefusedPart{"one_surface", shell_alone, {}, 3, "OneSurface", "surface", kNoCurve},
        RefusedPart{"nozzle_alone", nozzle_alone, {}, 3, "OneSurface", "surface", kNoCurve},
        RefusedPart{"metres", as_it_is, {}, 3, "NotMillimetres", "--unit m", kNoCurve, 1000.0},
        RefusedPart{"box_without_the_seam", as_it_is, Words{"--set", "seam.region_min_x_mm=500"}, 3,
                    "OutsideRegion", "none in the region", kNoCurve},
        RefusedPart{"no_gap_to_halve", as_it_is, Words{"--reference", "gap_middle"}, 3,
                    "NoSuchReference", "reference curve", kNoCurve},
        RefusedPart{"no_end_of_the_nozzle", as_it_is, Words{"--reference", "nozzle_edge"}, 3,
                    "NoSuchReference", "reference curve", kNoCurve},
        RefusedPart{"no_open_seam", shell_alone, Words{"--seam", "open"}, 3, "NoSeam",
                    "no two surfaces meet", kNoCurve},
        RefusedPart{"open_ring", half_unseen, {}, 4, "LowCoverage", "are asked for", kWithCurve},
        RefusedPart{"a_large_hole", sector_unseen, {}, 4, "LargeHole", "largest hole", kWithCurve}),
    [](const auto& part) { return std::string(part.param.name); });

/// The joint twice, the second one beside the first or in its place.
std::string two_joints(const Eigen::Vector3d& shift_mm, const test::ScratchFolder& scratch) {
  JointCloud both(small_joint());
  const JointCloud first(small_joint());
  const cloud::CloudView points = first.view().points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    both.add(shift_mm +
             Eigen::Vector3d(double{points.x[i]}, double{points.y[i]}, double{points.z[i]}));
  }
  return scratch.write("two.ply", ply_of(both.view().points, 1.0));
}

TEST(RefusedPart, of_two_plates_has_no_ring) {
  const test::ScratchFolder scratch;
  JointCloudConfig config = small_joint();
  plate_alone(config);
  JointCloud plates(config);
  for (int i = 0; i < 60; ++i) {
    for (int k = 1; k < 40; ++k) {
      plates.add({-60.0 + 2.0 * i, 0.0, 1.5 * k});
    }
  }
  const std::string cloud = scratch.write("plates.ply", ply_of(plates.view().points, 1.0));

  const Outcome outcome = run_program({"extract", cloud, "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  EXPECT_EQ(report_in(scratch)["seam"]["refusal"], "NoRing");
}

TEST(RefusedPart, with_two_equal_rings_shows_both) {
  const test::ScratchFolder scratch;
  const std::string cloud = two_joints({400.0, 0.0, 200.0}, scratch);

  const Outcome outcome = run_program({"extract", cloud, "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 4) << outcome.text;
  const auto seam = report_in(scratch)["seam"];
  EXPECT_EQ(seam["refusal"], "TwoRings");
  ASSERT_GE(seam["rings"].size(), 2U);
  EXPECT_EQ(seam["rings"][0]["fate"], "Chosen");
  EXPECT_EQ(seam["rings"][1]["fate"], "Equal");
}

TEST(ExtractedPart, whose_points_come_twice_gives_its_seam_all_the_same) {
  const test::ScratchFolder scratch;
  const std::string cloud = two_joints(Eigen::Vector3d::Zero(), scratch);

  const Outcome outcome = run_program({"extract", cloud, "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
}

/// The simulated cell at half size, welded without a robot.
Outcome weld(const std::string& camera, const std::string& assignment, const std::string& out) {
  return run_program({"weld", "--camera", camera, "--set", "cell.width=648", "--set",
                      "cell.height=483", "--set", assignment, "--out", out});
}

TEST(RefusedWeld, of_a_gap_too_wide_everywhere_keeps_all_but_the_path) {
  const test::ScratchFolder scratch;

  const Outcome outcome = weld("sim", "torch.max_gap_mm=0.5", scratch.path("out"));

  EXPECT_EQ(outcome.exit_code, 4) << outcome.text;
  EXPECT_NE(outcome.text.find("no stretch of the seam may be welded"), std::string::npos)
      << outcome.text;
  EXPECT_EQ(scratch.names_in("out"), reports_and({"merged.ply", "poses.json", "seam.csv"}));
}

TEST(RefusedWeld, of_a_part_outside_the_view_has_no_views_to_tie_together) {
  const test::ScratchFolder scratch;

  const Outcome outcome = weld("sim", "cell.dropout_share=1", scratch.path("out"));

  EXPECT_EQ(outcome.exit_code, 4) << outcome.text;
  EXPECT_NE(outcome.text.find("no two views could be tied together"), std::string::npos)
      << outcome.text;
  ASSERT_EQ(scratch.names_in("out"), reports_and({"poses.json"}));
  EXPECT_EQ(report_in(scratch)["verdict"]["weld"], false);
}

TEST(RefusedWeld, of_a_part_larger_than_the_workspace_names_the_key_and_gives_no_seam) {
  const test::ScratchFolder scratch;

  const Outcome outcome = weld("sim", "job.max_voxels=1000", scratch.path("out"));

  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  EXPECT_NE(outcome.text.find("job.max_voxels"), std::string::npos) << outcome.text;
  EXPECT_EQ(scratch.names_in("out"), reports_and({"merged.ply", "poses.json"}));
}

TEST(RefusedWeld, without_a_camera_of_that_name_is_a_fault_of_the_device_and_writes_nothing) {
  const test::ScratchFolder scratch;

  const Outcome outcome = weld("v4l2:/dev/none", "camera.focal_px=500", scratch.path("out"));

  EXPECT_EQ(outcome.exit_code, 5) << outcome.text;
  EXPECT_NE(outcome.text.find("/dev/none"), std::string::npos) << outcome.text;
  EXPECT_EQ(scratch.names_in("out"), Names{});
}

}  // namespace
}  // namespace dseam::program
