// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/pipes/pipe_match.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cstdio>
#include <numbers>

#include "pipe_scene.hpp"

namespace dseam::splice {
namespace {

using geometry::RigidTransform;
using test::find_pipes;
using test::look_from;
using test::nozzle_of;
using test::PatchView;
using test::PipeScene;
using test::shell_of;

constexpr double kInside = 12.592;  // chi-squared, six degrees of freedom, 95 %.

PipeScene part(double shell_mm, double nozzle_mm, double angle_rad, double eccentricity_mm) {
  return {{shell_of(shell_mm), nozzle_of(nozzle_mm, angle_rad, eccentricity_mm)}, true};
}

/// How often the pose between two views lies within its covariance.
double share_inside(const PipeScene& scene, double azimuth_a, double azimuth_b, int seeds) {
  const RigidTransform T_a_b = look_from(azimuth_a).inverse() * look_from(azimuth_b);
  const PatchView a(scene, look_from(azimuth_a));
  const PatchView b(scene, look_from(azimuth_b));
  int inside = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    Pcg32 random(static_cast<std::uint64_t>(seed) + 11);
    const PipePair pair_a = find_pipes(a.noisy(0.01, random).field());
    const PipePair pair_b = find_pipes(b.noisy(0.01, random).field());
    if (pair_a.state != PipePairState::kFound || pair_b.state != PipePairState::kFound) {
      continue;
    }
    const PipePlaces found = match_pipes(pair_a, pair_b, 0.0);
    const PipePlace& place = found.places[found.possible(0) ? 0 : 1];
    const geometry::Vector6 e = geometry::difference(place.T_a_b, T_a_b);
    inside += e.dot(place.covariance.ldlt().solve(e)) < kInside ? 1 : 0;
  }
  return static_cast<double>(inside) / seeds;
}

TEST(PipeMatch, the_pose_between_two_views_lies_within_its_covariance) {
  const double share = share_inside(part(108.0, 59.0, 1.25, 8.0), 0.9, 1.9, 300);

  std::printf("pose of two views by their pipes, 300 seeds: %.1f %% inside 95 %%\n", 100.0 * share);
  EXPECT_GE(share, 0.90);
  EXPECT_LE(share, 0.99);
}

TEST(PipeMatch, an_ovality_does_not_make_the_pose_surer_than_it_is) {
  PipeScene oval = part(120.0, 45.0, 1.3, 12.0);
  oval.pipes[0].ovality_mm = 0.3;
  oval.pipes[1].ovality_mm = 0.3;

  EXPECT_GE(share_inside(oval, 2.2, 3.4, 60), 0.90);
}

struct Found {
  PipePair a;
  PipePair b;
  RigidTransform T_a_b;
};

Found two_views(const PipeScene& scene_a, const PipeScene& scene_b) {
  Pcg32 random(3);
  return {find_pipes(PatchView(scene_a, look_from(0.6), true).noisy(0.01, random).field()),
          find_pipes(PatchView(scene_b, look_from(2.6), true).noisy(0.01, random).field()),
          look_from(0.6).inverse() * look_from(2.6)};
}

TEST(PipeMatch, an_oblique_part_fits_in_one_place) {
  const PipeScene scene = part(95.0, 40.0, 1.2, 0.0);
  const Found f = two_views(scene, scene);

  const PipePlaces places = match_pipes(f.a, f.b, 0.01);

  ASSERT_NE(places.possible(0), places.possible(1));
  const PipePlace& place = places.places[places.possible(0) ? 0 : 1];
  EXPECT_LT(place.chi_squared, PipePlaces::kFits);
  EXPECT_LT(geometry::difference(place.T_a_b, f.T_a_b).tail<3>().norm(), 1e-3);
}

TEST(PipeMatch, a_part_that_is_symmetric_about_its_nozzle_fits_in_two) {
  const PipeScene scene = part(108.0, 59.0, std::numbers::pi / 2.0, 0.0);
  const Found f = two_views(scene, scene);

  const PipePlaces places = match_pipes(f.a, f.b, 0.01);

  EXPECT_TRUE(places.possible(0) && places.possible(1));
}

TEST(PipeMatch, other_radii_another_angle_and_another_distance_fit_in_none) {
  const PipeScene scene = part(108.0, 59.0, 1.25, 8.0);
  for (const PipeScene& other : {part(112.0, 59.0, 1.25, 8.0), part(108.0, 56.0, 1.25, 8.0),
                                 part(108.0, 59.0, 1.35, 8.0), part(108.0, 59.0, 1.25, 14.0)}) {
    const Found f = two_views(scene, other);

    const PipePlaces places = match_pipes(f.a, f.b, 0.01);

    EXPECT_FALSE(places.possible(0) || places.possible(1));
  }
}

}  // namespace
}  // namespace dseam::splice
