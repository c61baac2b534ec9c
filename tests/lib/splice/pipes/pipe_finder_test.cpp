// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/pipes/pipe_finder.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pipe_scene.hpp"
#include "support/arena_owner.hpp"

namespace dseam::splice {
namespace {

using test::find_pipes;
using test::look_from;
using test::nozzle_of;
using test::PatchView;
using test::PipeScene;
using test::shell_of;

constexpr double kOblique = 1.25;

PipePair seen(const PipeScene& scene, double azimuth_rad = 1.0, double sigma_mm = 0.01) {
  Pcg32 random(5);
  return find_pipes(PatchView(scene, look_from(azimuth_rad), true).noisy(sigma_mm, random).field());
}

TEST(PipeFinder, shell_and_nozzle_are_told_apart_and_found) {
  const PipePair pair = seen({{shell_of(108.0), nozzle_of(59.0, kOblique, 8.0)}, true});

  const Eigen::Matrix3d to_camera = look_from(1.0).rotation.transpose();
  const Eigen::Vector3d nozzle_axis(std::cos(kOblique), 0.0, std::sin(kOblique));
  ASSERT_EQ(pair.state, PipePairState::kFound);
  EXPECT_NEAR(pair.shell.fit.cylinder.radius_mm, 108.0, 0.2);
  EXPECT_NEAR(pair.nozzle.fit.cylinder.radius_mm, 59.0, 0.2);
  EXPECT_NEAR(std::abs(pair.shell.fit.cylinder.axis.dot(to_camera.col(0))), 1.0, 1e-6);
  EXPECT_NEAR(pair.nozzle.fit.cylinder.axis.dot(to_camera * nozzle_axis), 1.0, 1e-5);
}

TEST(PipeFinder, round_pipes_are_not_called_oval) {
  const PipePair pair = seen({{shell_of(108.0), nozzle_of(59.0, kOblique, 8.0)}});

  EXPECT_EQ(pair.shell.ovality_mm, 0.0);
  EXPECT_EQ(pair.nozzle.ovality_mm, 0.0);
}

TEST(PipeFinder, an_ovality_of_three_tenths_is_told) {
  PipeScene scene{{shell_of(108.0), nozzle_of(59.0, kOblique, 8.0)}};
  scene.pipes[0].ovality_mm = 0.3;
  scene.pipes[1].ovality_mm = 0.3;

  const PipePair pair = seen(scene);

  EXPECT_NEAR(pair.shell.ovality_mm, 0.3, 0.1);
  EXPECT_NEAR(pair.nozzle.ovality_mm, 0.3, 0.15);
}

TEST(PipeFinder, what_is_no_pair_is_named) {
  PipeScene crushed{{shell_of(108.0), nozzle_of(59.0, kOblique, 8.0)}};
  crushed.pipes[1].ovality_mm = 2.0;
  test::ScenePipe beside = shell_of(60.0);
  beside.cylinder.point_mm = {0.0, 0.0, 80.0};
  test::ScenePipe stub = nozzle_of(59.0, kOblique, 8.0);
  stub.to_mm = 124.0;

  EXPECT_EQ(seen({{}, true}).state, PipePairState::kNoPipe);
  EXPECT_EQ(seen({{}, false}).state, PipePairState::kNoPipe);
  EXPECT_EQ(seen({{shell_of(108.0)}, true}).state, PipePairState::kOnePipe);
  EXPECT_EQ(seen({{shell_of(90.0), beside}}).state, PipePairState::kParallel);
  EXPECT_EQ(seen({{shell_of(60.2), nozzle_of(60.0, kOblique, 8.0)}}).state, PipePairState::kAlike);
  EXPECT_EQ(seen(crushed).state, PipePairState::kNotRound);
  EXPECT_EQ(seen({{shell_of(108.0), stub}}, 1.0, 0.2).state, PipePairState::kTooNarrow);
}

TEST(PipeFinder, of_two_nozzles_nobody_can_say_which_is_meant) {
  const PipePair pair = seen(
      {{shell_of(108.0), nozzle_of(35.0, 1.57, 0.0, -60.0), nozzle_of(35.0, 1.57, 0.0, 60.0)}});

  EXPECT_EQ(pair.state, PipePairState::kMorePipes);
}

TEST(PipeFinder, a_configuration_without_sense_is_refused) {
  test::ArenaOwner owner(PipeFinder::bytes());
  PipeFinder::Config few;
  few.min_patches = 3;
  PipeFinder::Config sure;
  sure.ovality_sigma_mm = 0.0;

  EXPECT_EQ(PipeFinder::make(few, owner.arena()).error(), Errc::kInvalidArgument);
  EXPECT_EQ(PipeFinder::make(sure, owner.arena()).error(), Errc::kInvalidArgument);
}

TEST(PipeFinder, the_same_view_gives_the_same_bits) {
  const PipeScene scene{{shell_of(108.0), nozzle_of(59.0, kOblique, 8.0)}};

  EXPECT_EQ(seen(scene).nozzle.fit.cylinder.point_mm, seen(scene).nozzle.fit.cylinder.point_mm);
}

}  // namespace
}  // namespace dseam::splice
