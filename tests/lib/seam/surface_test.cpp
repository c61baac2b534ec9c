// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/surface/surface.hpp"

#include <gtest/gtest.h>

#include <array>

#include "dseam/seam/seam_report.hpp"

namespace dseam::seam {
namespace {

const std::array<Surface, 4> kSurfaces = {
    Surface{SurfaceKind::kPlane, {3.0, -2.0, 7.0}, Eigen::Vector3d(0.2, -0.3, 0.9).normalized()},
    Surface{SurfaceKind::kSphere, {3.0, -2.0, 7.0}, Eigen::Vector3d::UnitZ(), 150.0},
    Surface{SurfaceKind::kCylinder, {3, -2, 7}, Eigen::Vector3d(0.8, 0.3, 0.1).normalized(), 60.0},
    Surface{SurfaceKind::kCone, {3, -2, 7}, Eigen::Vector3d(0.1, 0.3, 0.8).normalized(), 40.0, 0.2},
};
const Eigen::Vector3d kPoint(55.0, 21.0, -33.0);

TEST(Surface, the_jacobian_is_the_slope_of_the_distance_in_each_parameter) {
  for (const Surface& surface : kSurfaces) {
    const SurfaceVector jacobian = distance_jacobian(surface, kPoint);

    for (int i = 0; i < kMaxSurfaceParameters; ++i) {
      const SurfaceVector step = SurfaceVector::Unit(i) * 1e-6;
      const double slope = (signed_distance(stepped(surface, step), kPoint) -
                            signed_distance(stepped(surface, -step), kPoint)) /
                           2e-6;
      EXPECT_NEAR(jacobian[i], slope, 1e-5) << name(surface.kind) << " " << i;
    }
  }
}

TEST(Surface, the_outward_normal_is_the_gradient_of_the_distance) {
  for (const Surface& surface : kSurfaces) {
    const Eigen::Vector3d normal = outward_normal(surface, kPoint);

    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d step = Eigen::Vector3d::Unit(i) * 1e-6;
      const double slope =
          (signed_distance(surface, kPoint + step) - signed_distance(surface, kPoint - step)) /
          2e-6;
      EXPECT_NEAR(normal[i], slope, 1e-6) << name(surface.kind);
    }
  }
}

}  // namespace
}  // namespace dseam::seam
