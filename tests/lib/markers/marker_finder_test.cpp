// SPDX-License-Identifier: Apache-2.0
// Discs whose centre is known in closed form, drawn pixel by pixel apart from the simulator.
#include "dseam/markers/marker_finder.hpp"

#include <gtest/gtest.h>

#include <string>

#include "disc_image.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"

namespace dseam::markers {
namespace {

using test::DiscImage;
using test::DiscScene;

struct Found {
  std::vector<Marker> markers;
  MarkerFinder::Report report;
};

Found find(const DiscImage& image) {
  test::ArenaOwner owner(MarkerFinder::bytes(image.camera.width));
  auto finder = MarkerFinder::make({}, image.camera.width, owner.arena());
  std::vector<Marker> storage(64);
  Buffer<Marker> out(storage);

  const test::AllocationCounter allocations;
  const MarkerFinder::Report report = finder.value().run(image.view(), out);
  EXPECT_EQ(allocations.count(), 0U);

  return {{out.view().begin(), out.view().end()}, report};
}

/// Mean error of the centre over places between the pixels: what scatter leaves is bias.
struct Bias {
  Eigen::Vector2d px = Eigen::Vector2d::Zero();
  double depth_mm = 0.0;
};

Bias mean_error(DiscScene scene) {
  constexpr int kPlaces = 12;
  const Eigen::Vector3d around = scene.centre_mm;
  const double mm_per_px = around.z() / scene.camera.fx;
  Bias sum;
  for (std::uint64_t place = 0; place < kPlaces; ++place) {
    Pcg32 random(place, 9);
    const double right = random.uniform();
    scene.centre_mm = around + mm_per_px * Eigen::Vector3d(right, random.uniform(), 0.0);
    const Found found = find(DiscImage(scene, place));
    EXPECT_EQ(found.markers.size(), 1U);
    if (found.markers.size() == 1) {
      const Marker& m = found.markers.front();
      sum.px += (Eigen::Vector2d(m.u, m.v) - scene.centre_px()) / kPlaces;
      sum.depth_mm += (m.p_camera.z() - scene.centre_mm.z()) / kPlaces;
    }
  }
  return sum;
}

Eigen::Vector3d leaning(double degrees) {
  const double tilt = degrees * std::numbers::pi / 180.0;
  return {0.0, -std::sin(tilt), -std::cos(tilt)};
}

struct BiasCase {
  const char* name;
  DiscScene scene;
};

std::vector<BiasCase> bias_cases() {
  std::vector<BiasCase> cases;
  const auto add = [&cases](const char* name) -> DiscScene& {
    cases.push_back({name, {}});
    cases.back().scene.gray_noise = 0.7;
    return cases.back().scene;
  };
  add("on_a_plane_that_leans");
  add("on_a_plane_seen_at_a_grazing_angle").normal = leaning(65.0);
  add("under_light_that_falls_unevenly").shading_per_px = {0.0, 0.004};
  add("beside_gloss_that_grows").gloss_per_px = {0.3, 0.5};
  DiscScene& dark = add("that_is_dark_on_light");
  dark.disc_gray = 60.0;
  dark.ground_gray = 180.0;
  dark.shading_per_px = {0.0, 0.003};
  add("on_a_small_pipe").cylinder_radius_mm = 50.0;
  DiscScene& grazing = add("on_a_pipe_at_a_grazing_angle");
  grazing.cylinder_radius_mm = 108.0;
  grazing.normal = leaning(65.0);
  DiscScene& sloping = add("on_a_pipe_that_slopes");
  sloping.cylinder_radius_mm = 50.0;
  sloping.along = {0.0, 1.0, -1.0};
  add("with_a_soft_edge").soft_px = 1.0;
  DiscScene& half = add("in_half_the_pixels_under_uneven_light");
  half.camera.fx = half.camera.fy = 1036.8;
  half.shading_per_px = {0.0, 0.004};
  return cases;
}

class DiscCentre : public testing::TestWithParam<BiasCase> {};

TEST_P(DiscCentre, is_found_without_bias) {
  const Bias bias = mean_error(GetParam().scene);

  EXPECT_LT(bias.px.norm(), 0.006);
  EXPECT_LT(std::abs(bias.depth_mm), 0.003);
}

INSTANTIATE_TEST_SUITE_P(MarkerFinder, DiscCentre, testing::ValuesIn(bias_cases()),
                         [](const auto& which) { return std::string(which.param.name); });

TEST(MarkerFinder, errors_of_the_centre_are_as_large_as_stated) {
  constexpr int kSeeds = 60;
  DiscScene scene;
  scene.gray_noise = 3.0;
  double normalised = 0.0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    Pcg32 random(seed, 11);
    scene.centre_mm.x() = 0.3 * random.uniform();
    const Found found = find(DiscImage(scene, seed));
    ASSERT_EQ(found.markers.size(), 1U);
    const Marker& m = found.markers.front();
    const double error = (Eigen::Vector2d(m.u, m.v) - scene.centre_px()).norm();
    normalised += error * error / (2.0 * m.sigma_px * m.sigma_px * kSeeds);
  }

  EXPECT_GT(normalised, 0.3);
  EXPECT_LT(normalised, 1.4);
}

TEST(MarkerFinder, a_disc_without_depth_takes_its_place_from_the_depth_around_it) {
  DiscScene scene;
  scene.depth_on_disc = false;

  const Found found = find(DiscImage(scene));

  ASSERT_EQ(found.markers.size(), 1U);
  EXPECT_TRUE(found.markers[0].has_depth);
  EXPECT_LT((found.markers[0].p_camera - scene.centre_mm).norm(), 0.01);
  EXPECT_NEAR(found.markers[0].radius_mm, scene.radius_mm, 0.05);
}

TEST(MarkerFinder, a_hole_is_no_disc) {
  DiscScene scene;
  scene.disc_gray = 20.0;
  scene.hole_mm = 8.0;

  const Found found = find(DiscImage(scene));

  EXPECT_TRUE(found.markers.empty());
  EXPECT_EQ(found.report.rejected_hole, 1U);
}

TEST(MarkerFinder, a_specular_spot_is_no_disc) {
  DiscScene scene;
  scene.ground_gray = 120.0;
  scene.disc_gray = 250.0;
  scene.soft_px = 4.0;

  const Found found = find(DiscImage(scene));

  EXPECT_TRUE(found.markers.empty());
  EXPECT_GE(found.report.candidates, 1U);
}

TEST(MarkerFinder, a_disc_that_is_partly_covered_is_no_disc) {
  for (const double covered_px : {1.0, 2.5, 5.0, 8.0}) {
    DiscScene scene;
    scene.missing_from_u = scene.centre_px().x() + 9.7 - covered_px;

    const Found found = find(DiscImage(scene));

    // A pixel that is lost may pass: then its sigma says how far off the centre may be.
    for (const Marker& m : found.markers) {
      EXPECT_LT(std::abs(m.u - scene.centre_px().x()), 3.0 * m.sigma_px) << covered_px;
    }
    if (covered_px > 2.0) {
      EXPECT_TRUE(found.markers.empty()) << covered_px;
    }
  }
}

TEST(MarkerFinder, a_frame_without_gray_is_named) {
  DiscImage image{DiscScene{}};
  image.gray.clear();

  const Found found = find(image);

  EXPECT_FALSE(found.report.gray_usable);
  EXPECT_TRUE(found.markers.empty());
}

}  // namespace
}  // namespace dseam::markers
