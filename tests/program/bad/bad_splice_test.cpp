// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "program/support/run_program.hpp"
#include "program/support/sim_scan_set.hpp"

namespace dseam::program {
namespace {

using hal::replay::ScanView;

/// What `dseam splice` said of a scan set of three views, which `edit` has spoilt.
struct Spliced {
  int exit_code = -1;
  std::vector<std::string> states;
};

template <typename Edit>
Spliced splice(std::uint32_t markers, const Edit& edit) {
  hal::sim::CellConfig config = test::half_size_cell();
  config.markers.count = markers;
  config.views.count = 3;
  config.views.azimuth_span_rad = 1.6;
  const test::ScratchFolder scratch;
  test::write_scan_set({config}, scratch.path("set"), edit);
  Spliced out;
  out.exit_code =
      test::run_program({"splice", scratch.path("set"), "--out", scratch.path("out")}).exit_code;
  const auto poses = nlohmann::json::parse(std::ifstream(scratch.path("out/poses.json")));
  for (const auto& pose : poses) {
    out.states.push_back(pose.at("state"));
  }
  return out;
}

void without_pose(std::uint32_t, ScanView& view) { view.camera.T_base_camera.reset(); }

template <typename T>
void mirror(std::vector<T>& pixels, std::uint32_t width) {
  for (auto row = pixels.begin(); row != pixels.end(); row += width) {
    std::reverse(row, row + width);
  }
}

using States = std::vector<std::string>;

TEST(BadSplice, neither_poses_nor_markers_is_refused) {
  const Spliced spliced = splice(0, without_pose);

  EXPECT_EQ(spliced.exit_code, 4);
  EXPECT_EQ(spliced.states,
            (States{"used", "ambiguous", "ambiguous"}));  // Two places by its pipes.
}

TEST(BadSplice, the_same_frame_twice_is_named) {
  ScanView first;

  const Spliced spliced = splice(18, [&](std::uint32_t i, ScanView& view) {
    if (i == 0) {
      first = view;
    }
    view.depth = i == 1 ? first.depth : view.depth;
    view.gray = i == 1 ? first.gray : view.gray;
  });

  EXPECT_EQ(spliced.exit_code, 0);
  EXPECT_EQ(spliced.states, (States{"used", "duplicate", "used"}));
}

TEST(BadSplice, views_that_do_not_overlap_are_refused) {
  const Spliced spliced = splice(0, [](std::uint32_t i, ScanView& view) {
    view.camera.T_base_camera->translation_mm.x() += 2000.0 * i;
  });

  EXPECT_EQ(spliced.exit_code, 4);
  EXPECT_EQ(spliced.states, (States{"used", "no overlap", "no overlap"}));
}

TEST(BadSplice, a_mirrored_marker_field_is_not_spliced) {
  const Spliced spliced = splice(18, [](std::uint32_t i, ScanView& view) {
    without_pose(i, view);
    if (i == 1) {
      mirror(view.depth, view.camera.intrinsics.width);
      mirror(view.gray, view.camera.intrinsics.width);
    }
  });

  EXPECT_NE(spliced.states.at(1), "used");
}

}  // namespace
}  // namespace dseam::program
