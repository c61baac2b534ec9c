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

/// A part that is refused, and what the program says and leaves.
struct RefusedPart {
  const char* name;
  void (*change)(JointCloudConfig& config);
  std::vector<std::string> options;
  int exit_code;
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
  EXPECT_EQ(scratch.names_in("out"), part.files);
}

void shell_alone(JointCloudConfig& config) { config.nozzle = false; }
void plate_alone(JointCloudConfig& config) {
  config.nozzle = false;
  config.shell = JointCloudConfig::Shell::kPlane;
  config.noise_mm = 0.0;
}
void as_it_is(JointCloudConfig&) {}
void half_unseen(JointCloudConfig& config) { config.unseen_width_rad = 2.5; }

INSTANTIATE_TEST_SUITE_P(
    Parts, RefusedPartTest,
    ::testing::Values(
        RefusedPart{"one_plane", plate_alone, {}, 3, "in one plane", reports_and({"merged.ply"})},
        RefusedPart{"one_surface", shell_alone, {}, 3, "surface", reports_and({"merged.ply"})},
        RefusedPart{"metres", as_it_is, {}, 3, "--unit m", reports_and({"merged.ply"}), 1000.0},
        RefusedPart{"no_such_reference",
                    as_it_is,
                    {"--reference", "gap_middle"},
                    3,
                    "reference curve",
                    reports_and({"merged.ply"})},
        RefusedPart{"no_open_seam",
                    shell_alone,
                    {"--seam", "open"},
                    3,
                    "no two surfaces meet",
                    reports_and({"merged.ply"})},
        RefusedPart{"a_large_hole",
                    half_unseen,
                    {},
                    4,
                    "largest hole",
                    reports_and({"merged.ply", "seam.csv"})}),
    [](const auto& part) { return std::string(part.param.name); });

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
