// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/truth.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dseam/hal/sim/cell.hpp"

namespace dseam::hal::sim {
namespace {

using Eigen::Vector3d;
using seam::ReferenceCurve;

constexpr double kPi = std::numbers::pi;

JointConfig plane_joint(double gap_mm) {
  JointConfig joint;
  joint.shell = ShellKind::kPlane;
  joint.gap_mm = gap_mm;
  return joint;
}

double worst_distance_from_circle(const TruthCurve& curve, double radius, double z) {
  double worst = 0.0;
  for (const TruthPoint& point : curve.points) {
    worst = std::max(worst, std::abs(std::hypot(point.p.x(), point.p.y()) - radius));
    worst = std::max(worst, std::abs(point.p.z() - z));
  }
  return worst;
}

TEST(TruthCurve, an_upright_nozzle_on_a_plate_gives_circles) {
  const JointConfig joint = plane_joint(3.0);

  const auto edge = truth_curve(joint, ReferenceCurve::kShellEdge);
  const auto root = truth_curve(joint, ReferenceCurve::kRoot);
  const auto middle = truth_curve(joint, ReferenceCurve::kGapMiddle);

  EXPECT_LT(worst_distance_from_circle(*edge, 62.2, 0.0), 1e-9);
  EXPECT_LT(worst_distance_from_circle(*root, 59.2, 0.0), 1e-9);
  EXPECT_LT(worst_distance_from_circle(*middle, 60.7, 0.0), 1e-9);
  EXPECT_NEAR(edge->length_mm, 2.0 * kPi * 62.2, 1e-5);
}

TEST(TruthCurve, a_set_in_nozzle_has_no_edge_that_faces_the_shell) {
  EXPECT_FALSE(truth_curve(plane_joint(3.0), ReferenceCurve::kNozzleEdge));
}

TEST(TruthCurve, the_edge_of_a_nozzle_set_on_stands_a_gap_above_the_root) {
  JointConfig joint = plane_joint(2.0);
  joint.kind = JointKind::kSetOn;

  const auto nozzle_edge = truth_curve(joint, ReferenceCurve::kNozzleEdge);
  const auto middle = truth_curve(joint, ReferenceCurve::kGapMiddle);
  const auto shell_edge = truth_curve(joint, ReferenceCurve::kShellEdge);

  EXPECT_LT(worst_distance_from_circle(*nozzle_edge, 59.2, 2.0), 1e-9);
  EXPECT_LT(worst_distance_from_circle(*middle, 59.2, 1.0), 1e-9);
  EXPECT_LT(worst_distance_from_circle(*shell_edge, 59.2, 0.0), 1e-9);
}

TEST(TruthCurve, points_of_a_saddle_lie_on_both_surfaces) {
  JointConfig joint;
  joint.axis_angle_rad = 65.0 * kPi / 180.0;
  joint.eccentricity_mm = 15.0;
  joint.gap_mm = 0.0;
  const Vector3d axis(std::cos(joint.axis_angle_rad), 0.0, std::sin(joint.axis_angle_rad));

  const auto root = truth_curve(joint, ReferenceCurve::kRoot);

  ASSERT_TRUE(root);
  for (const TruthPoint& point : root->points) {
    const Vector3d from_axis = point.p - Vector3d(0.0, 15.0, 0.0);
    EXPECT_NEAR(std::hypot(point.p.y(), point.p.z() + 108.0), 108.0, 1e-9);
    EXPECT_NEAR((from_axis - axis.dot(from_axis) * axis).norm(), 59.2, 1e-9);
  }
}

TEST(TruthCurve, tangents_are_those_of_the_points_and_normals_stand_on_them) {
  JointConfig joint;
  joint.axis_angle_rad = 70.0 * kPi / 180.0;
  joint.nozzle_ovality_mm = 0.3;
  for (const auto reference :
       {ReferenceCurve::kRoot, ReferenceCurve::kShellEdge, ReferenceCurve::kGapMiddle}) {
    const auto curve = truth_curve(joint, reference);
    const std::size_t count = curve->points.size();
    for (std::size_t i = 0; i < count; ++i) {
      const TruthPoint& point = curve->points[i];
      const Vector3d chord =
          curve->points[(i + 1) % count].p - curve->points[(i + count - 1) % count].p;

      EXPECT_GT(point.tangent.dot(chord.normalized()), 1.0 - 1e-6);
      EXPECT_NEAR(chord.norm(), 2.0 * curve->length_mm / static_cast<double>(count), 1e-3);
      // Across a gap the nozzle's normal is that of a curve with another radius.
      const double play = reference == ReferenceCurve::kRoot ? 1e-9 : 5e-3;
      EXPECT_NEAR(point.tangent.dot(point.n_shell), 0.0, play);
      EXPECT_NEAR(point.tangent.dot(point.n_nozzle), 0.0, play);
    }
  }
}

TEST(TruthCurve, the_dihedral_runs_from_acute_to_obtuse_round_an_oblique_nozzle) {
  JointConfig joint = plane_joint(0.0);
  joint.axis_angle_rad = 60.0 * kPi / 180.0;

  const auto root = truth_curve(joint, ReferenceCurve::kRoot);

  double least = kPi;
  double most = 0.0;
  for (const TruthPoint& point : root->points) {
    least = std::min(least, point.dihedral_rad);
    most = std::max(most, point.dihedral_rad);
  }
  EXPECT_NEAR(least, 60.0 * kPi / 180.0, 1e-4);
  EXPECT_NEAR(most, 120.0 * kPi / 180.0, 1e-4);
}

bool inside_any(const Scene& scene, const Vector3d& p) {
  return std::ranges::any_of(scene.bodies,
                             [&p](const Body& body) { return body.solid.contains(p); });
}

/// Steps across the seam just below and just above the shell's surface, along the shell and away
/// from the nozzle.
struct Around {
  bool below_inwards = false;
  bool below_outwards = false;
  bool above_inwards = false;
  bool above_outwards = false;
};

Around solid_around(const Scene& scene, const TruthPoint& at) {
  constexpr double kStep = 0.01;
  Vector3d outwards = at.tangent.cross(at.n_shell).normalized();
  outwards = outwards.dot(at.n_nozzle) < 0.0 ? Vector3d(-outwards) : outwards;
  const Vector3d out = kStep * outwards;
  const Vector3d up = 0.1 * kStep * at.n_shell;
  return {inside_any(scene, at.p - out - up), inside_any(scene, at.p + out - up),
          inside_any(scene, at.p - out + up), inside_any(scene, at.p + out + up)};
}

/// The truth and the solids that are scanned come from different formulas: the one must lie on the
/// edge of the other to a hundredth of a millimetre, all round.
void expect_on_the_edge(const JointConfig& joint, bool gap) {
  CellConfig config;
  config.joint = joint;
  const Scene scene = make_scene(config);
  const auto curve = truth_curve(joint, ReferenceCurve::kShellEdge);
  ASSERT_TRUE(curve);
  for (const TruthPoint& point : curve->points) {
    const Around solid = solid_around(scene, point);

    ASSERT_TRUE(solid.below_outwards) << "the shell is outside";
    ASSERT_FALSE(solid.above_outwards) << "air is above it";
    ASSERT_EQ(solid.below_inwards, !gap) << "then the gap, or the nozzle";
    ASSERT_EQ(solid.above_inwards, !gap);
  }
}

TEST(TruthCurve, lies_on_the_edge_of_the_solids_that_are_scanned) {
  JointConfig joint;
  joint.axis_angle_rad = 68.0 * kPi / 180.0;
  joint.eccentricity_mm = 12.0;
  for (const double gap_mm : {0.0, 2.0}) {
    for (const double taper_rad : {0.0, 0.15}) {
      for (const ShellKind shell : {ShellKind::kCylinder, ShellKind::kPlane, ShellKind::kSphere}) {
        joint.gap_mm = gap_mm;
        joint.nozzle_taper_rad = taper_rad;
        joint.shell = shell;
        joint.shell_radius_mm = shell == ShellKind::kSphere ? 150.0 : 108.0;
        joint.nozzle_ovality_mm = 0.3;
        joint.hole_shift_x_mm = 0.3 * gap_mm;

        expect_on_the_edge(joint, gap_mm > 0.0);
      }
    }
  }
}

}  // namespace
}  // namespace dseam::hal::sim
