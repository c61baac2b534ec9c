// SPDX-License-Identifier: Apache-2.0
#include "dseam/geometry/cylinder_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "dseam/base/random.hpp"
#include "support/allocation_counter.hpp"

namespace dseam::geometry {
namespace {

struct Points {
  std::vector<float> x, y, z;
  void add(const Eigen::Vector3d& p) {
    x.push_back(static_cast<float>(p.x()));
    y.push_back(static_cast<float>(p.y()));
    z.push_back(static_cast<float>(p.z()));
  }
  PointSpans view() const { return {x, y, z}; }
};

double gauss(Pcg32& random) {
  const double u = 1.0 - random.uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * random.uniform());
}

struct Sampled {
  Points points, normals;
};

Sampled sample(const Cylinder& c, double arc_rad, double length_mm, double sigma_mm, int count,
               Pcg32& random) {
  Sampled out;
  Eigen::Vector3d e1;
  Eigen::Vector3d e2;
  orthonormal_base(c.axis, e1, e2);
  for (int i = 0; i < count; ++i) {
    const double angle = arc_rad * (random.uniform() - 0.5);
    const double along = length_mm * (random.uniform() - 0.5);
    const Eigen::Vector3d n = e1 * std::cos(angle) + e2 * std::sin(angle);
    out.points.add(c.point_mm + c.axis * along + n * (c.radius_mm + sigma_mm * gauss(random)));
    out.normals.add(n);
  }
  return out;
}

const Cylinder kPipe{{40.0, -25.0, 640.0}, Eigen::Vector3d(0.3, 0.9, -0.2).normalized(), 108.0};

double axis_distance(const Cylinder& a, const Cylinder& b) {
  return a.axis.cross(b.point_mm - a.point_mm).norm();
}

TEST(CylinderFit, guess_from_exact_normals_is_the_cylinder) {
  Pcg32 random(1);
  const Sampled s = sample(kPipe, 1.5, 200.0, 0.0, 2000, random);

  const auto guess = guess_cylinder(s.points.view(), s.normals.view());

  ASSERT_TRUE(guess.has_value());
  EXPECT_NEAR(guess->radius_mm, 108.0, 1e-3);
  EXPECT_NEAR(std::abs(guess->axis.dot(kPipe.axis)), 1.0, 1e-9);
  EXPECT_LT(axis_distance(*guess, kPipe), 1e-3);
}

TEST(CylinderFit, a_plane_is_not_guessed_to_be_a_cylinder) {
  Points points;
  Points normals;
  for (int i = 0; i < 100; ++i) {
    points.add({double(i % 10), double(i) / 10.0, 600.0});
    normals.add(Eigen::Vector3d::UnitZ());
  }

  EXPECT_FALSE(guess_cylinder(points.view(), normals.view()).has_value());
}

TEST(CylinderFit, errors_of_noisy_fits_agree_with_their_covariance) {
  double nees = 0.0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    Pcg32 random(static_cast<std::uint64_t>(run) + 7);
    const Sampled s = sample(kPipe, 1.2, 150.0, 0.05, 400, random);
    Cylinder start = kPipe;
    start.point_mm += Eigen::Vector3d(2.0, -1.0, 2.0);
    start.radius_mm -= 3.0;

    const CylinderFit fit = fit_cylinder(s.points.view(), start, {});

    ASSERT_EQ(fit.state, FitState::kConverged);
    const Eigen::Vector3d foot =
        kPipe.point_mm + kPipe.axis * kPipe.axis.dot(fit.cylinder.point_mm - kPipe.point_mm);
    const Eigen::Vector3d shift = fit.cylinder.point_mm - foot;
    const Eigen::Vector3d axis =
        fit.cylinder.axis * (fit.cylinder.axis.dot(kPipe.axis) > 0.0 ? 1.0 : -1.0);
    Eigen::Matrix<double, 5, 1> e;
    e << shift.dot(fit.e1), shift.dot(fit.e2), (axis - kPipe.axis).dot(fit.e1),
        (axis - kPipe.axis).dot(fit.e2), fit.cylinder.radius_mm - kPipe.radius_mm;
    nees += e.dot(fit.covariance.inverse() * e) / kRuns;
  }

  EXPECT_NEAR(nees, 5.0, 1.0);
}

TEST(CylinderFit, a_fifth_of_far_points_does_not_move_it) {
  Pcg32 random(3);
  Sampled s = sample(kPipe, 1.5, 200.0, 0.02, 2000, random);
  for (int i = 0; i < 500; ++i) {
    s.points.add(kPipe.point_mm + Eigen::Vector3d(200.0 * random.uniform(), 0.0, -160.0));
  }
  s.points.add(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));

  const test::AllocationCounter allocations;
  const CylinderFit fit = fit_cylinder(s.points.view(), kPipe, {});

  EXPECT_EQ(allocations.count(), 0U);
  EXPECT_EQ(fit.state, FitState::kConverged);
  EXPECT_NEAR(fit.cylinder.radius_mm, 108.0, 0.05);
  EXPECT_NEAR(fit.rms_mm, 0.02, 0.005);
}

TEST(CylinderFit, points_of_a_plane_and_too_few_points_are_named) {
  Points plane;
  for (int i = 0; i < 400; ++i) {
    plane.add({double(i % 20), double(i) / 20.0, 600.0});
  }
  const Cylinder start{{0.0, 0.0, 500.0}, Eigen::Vector3d::UnitX(), 100.0};
  Points few;
  few.add({0.0, 0.0, 600.0});

  EXPECT_NE(fit_cylinder(plane.view(), start, {}).state, FitState::kConverged);
  EXPECT_EQ(fit_cylinder(few.view(), start, {}).state, FitState::kTooFewPoints);
}

}  // namespace
}  // namespace dseam::geometry
