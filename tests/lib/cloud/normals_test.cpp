// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/normals.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>
#include <vector>

#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/clouds.hpp"

namespace dseam::cloud {
namespace {

using geometry::Vec3f;
using search::GridIndex;
using test::Family;
using test::OwnedCloud;

constexpr std::size_t kMostPoints = 1000;

class NormalsTest : public ::testing::TestWithParam<int> {
 protected:
  NormalsTest() : index_(GridIndex::make(kMostPoints, memory_.arena()).value()) {}

  NormalEstimation::Report estimate(const OwnedCloud& cloud, NormalEstimation::Config config,
                                    std::span<const Vec3f> sensors = {},
                                    std::span<const ViewMask> seen_by = {}) {
    index_.rebuild(cloud.view());
    return NormalEstimation::make(config).value().run(index_, {cloud.view(), {}, seen_by}, sensors,
                                                      normals_);
  }

  test::ArenaOwner memory_{GridIndex::bytes(kMostPoints) + NormalsBuffer::bytes(kMostPoints)};
  GridIndex index_;
  NormalsBuffer normals_{kMostPoints, memory_.arena()};
};

OwnedCloud plane(float tilt, Vec3f shift) {
  OwnedCloud cloud;
  for (int i = 0; i < 400; ++i) {
    const auto x = static_cast<float>(i % 20);
    cloud.add(x + shift.x, static_cast<float>(i / 20) + shift.y, tilt * x + shift.z);
  }
  return cloud;
}

TEST_F(NormalsTest, a_plane_has_its_normal_even_far_from_the_origin) {
  for (const float away : {0.0F, 1000.0F, 20000.0F}) {
    const Vec3f sensor{away, -away, away + 500.0F};
    const auto report =
        estimate(plane(0.5F, {away, -away, away}), {.radius_mm = 3.0F}, {&sensor, 1});

    EXPECT_EQ(report.good, 400U);
    EXPECT_EQ(report.not_oriented, 0U);
    for (std::size_t i = 0; i < 400; ++i) {
      EXPECT_NEAR(normals_.nx[i], -0.5F / std::sqrt(1.25F), 1e-3F * (1.0F + away / 2000.0F));
      EXPECT_NEAR(normals_.nz[i], 1.0F / std::sqrt(1.25F), 1e-3F * (1.0F + away / 2000.0F));
    }
  }
}

TEST_F(NormalsTest, each_point_turns_to_the_view_that_saw_it) {
  const std::vector<Vec3f> sensors{{10.0F, 10.0F, 500.0F}, {10.0F, 10.0F, -500.0F}};
  std::vector<ViewMask> seen_by(400, 1);
  std::fill(seen_by.begin() + 200, seen_by.end(), ViewMask{2});
  seen_by[5] = 0;

  const auto report = estimate(plane(0.0F, {}), {.radius_mm = 3.0F}, sensors, seen_by);

  EXPECT_EQ(report.not_oriented, 1U);
  EXPECT_EQ(normals_[100], (Vec3f{0.0F, 0.0F, 1.0F}));
  EXPECT_EQ(normals_[300], (Vec3f{0.0F, 0.0F, -1.0F}));
}

TEST_F(NormalsTest, degenerate_neighbourhoods_have_a_name_and_no_normal) {
  OwnedCloud cloud;
  for (int i = 0; i < 10; ++i) {
    cloud.add(static_cast<float>(i), 0.5F * static_cast<float>(i), 0.0F);  // A line,
    cloud.add(100.0F, 0.0F, 0.0F);                                         // one place,
  }
  cloud.add(200.0F, 0.0F, 0.0F);           // a lone point,
  cloud.add(NAN, 0.0F, 0.0F);              // no point,
  for (const float off : {-1.0F, 1.0F}) {  // and an octahedron round its centre.
    cloud.add(300.0F + off, 0.0F, 0.0F);
    cloud.add(300.0F, off, 0.0F);
    cloud.add(300.0F, 0.0F, off);
  }

  const auto report = estimate(cloud, {.radius_mm = 2.5F});

  EXPECT_EQ(normals_.state[0], NormalState::kCollinear);
  EXPECT_EQ(normals_.state[1], NormalState::kCollinear);
  EXPECT_EQ(normals_.state[20], NormalState::kTooFew);
  EXPECT_EQ(normals_.state[21], NormalState::kTooFew);
  EXPECT_EQ(normals_.state[22], NormalState::kAmbiguous);
  EXPECT_EQ(report.good, 0U);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(normals_[i], Vec3f{});
    EXPECT_TRUE(std::isfinite(normals_.variation[i]));
  }
}

TEST_F(NormalsTest, refuses_what_makes_no_sense_and_allocates_nothing) {
  const OwnedCloud cloud = test::make_cloud(Family::kSurface, 500, 1);
  EXPECT_FALSE(NormalEstimation::make({.radius_mm = NAN}).ok());
  EXPECT_FALSE(NormalEstimation::make({.min_width_ratio = -1.0F}).ok());
  const test::AllocationCounter allocations;

  estimate(cloud, {});

  EXPECT_EQ(allocations.count(), 0U);
}

// The covariance about the mean in double, decomposed by Eigen.
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> by_brute_force(const OwnedCloud& cloud,
                                                              std::size_t i, float radius_mm) {
  std::vector<Eigen::Vector3d> near;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < cloud.size(); ++j) {
    if (geometry::squared_norm(cloud.view()[j] - cloud.view()[i]) <= radius_mm * radius_mm) {
      near.emplace_back(static_cast<double>(cloud.x[j]), static_cast<double>(cloud.y[j]),
                        static_cast<double>(cloud.z[j]));
      mean += near.back();
    }
  }
  mean /= static_cast<double>(near.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& p : near) {
    covariance += (p - mean) * (p - mean).transpose() / static_cast<double>(near.size());
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance);
}

double moment_about(const OwnedCloud& cloud, std::size_t i, float radius_mm) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t j = 0; j < cloud.size(); ++j) {
    const float squared = geometry::squared_norm(cloud.view()[j] - cloud.view()[i]);
    if (squared <= radius_mm * radius_mm) {
      sum += static_cast<double>(squared);
      ++count;
    }
  }
  return sum / count;
}

// Whether the neighbours lie so clearly in a plane that rounding cannot hide it.
bool has_clear_plane(const OwnedCloud& cloud, std::size_t i, float radius_mm) {
  const Vec3f p = cloud.view()[i];
  if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) {
    return false;
  }
  const Eigen::Vector3d lambda = by_brute_force(cloud, i, radius_mm).eigenvalues();
  const double rounding = 1e-5 * moment_about(cloud, i, radius_mm);
  return lambda[1] > 4e-4 * lambda[2] + rounding &&
         lambda[1] - lambda[0] > 0.02 * lambda[1] + rounding;
}

TEST_P(NormalsTest, are_those_of_the_covariance_in_double) {
  const auto family = static_cast<Family>(GetParam());
  for (std::uint64_t seed = 0; seed < 12 && !HasFailure(); ++seed) {
    const OwnedCloud cloud = test::make_cloud(family, 50 + 60 * seed, seed);
    estimate(cloud, {.radius_mm = 3.0F});
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (normals_.state[i] != NormalState::kGood) {
        EXPECT_FALSE(has_clear_plane(cloud, i, 3.0F)) << i;
        continue;
      }
      const auto truth = by_brute_force(cloud, i, 3.0F);
      const Eigen::Vector3d lambda = truth.eigenvalues();
      const Eigen::Vector3d found(static_cast<double>(normals_.nx[i]),
                                  static_cast<double>(normals_.ny[i]),
                                  static_cast<double>(normals_.nz[i]));
      // Sums in float are off by some 1e-6 of the moment about the point, which turns the vector by
      // that over the gap between the two lesser values.
      const double turned = 4e-6 * moment_about(cloud, i, 3.0F) / (lambda[1] - lambda[0]);
      EXPECT_LT(found.cross(truth.eigenvectors().col(0)).norm(), 1e-6 + turned) << i;
      const double rounding = 4e-6 * moment_about(cloud, i, 3.0F) / lambda.sum();
      EXPECT_NEAR(normals_.variation[i], lambda[0] / lambda.sum(), rounding);
      EXPECT_NEAR(found.norm(), 1.0, 1e-6);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, NormalsTest, ::testing::Range(0, test::kNumFamilies),
                         [](const auto& family) {
                           return std::string(test::name(static_cast<Family>(family.param)));
                         });

}  // namespace
}  // namespace dseam::cloud
