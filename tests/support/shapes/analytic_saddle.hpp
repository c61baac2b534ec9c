// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "dseam/seam/seam_curve.hpp"

namespace dseam::test {

/// A round nozzle on a round shell in closed form. The shell's axis is x, the nozzle's leans from z
/// towards x by 90 degrees minus `axes_rad` and stands `eccentric_mm` off the shell's axis.
struct Saddle {
  double shell_mm = 100.0;
  double nozzle_mm = 40.0;
  double axes_rad = std::numbers::pi / 2.0;
  double eccentric_mm = 0.0;

  [[nodiscard]] seam::SeamPoint at(double phi_rad) const {
    const double lean = std::numbers::pi / 2.0 - axes_rad;
    const Eigen::Vector3d w(std::sin(lean), 0.0, std::cos(lean));
    const Eigen::Vector3d u(std::cos(lean), 0.0, -std::sin(lean));
    const Eigen::Vector3d v = Eigen::Vector3d::UnitY();
    const Eigen::Vector3d radial = std::cos(phi_rad) * u + std::sin(phi_rad) * v;
    const Eigen::Vector3d q = eccentric_mm * v + nozzle_mm * radial;
    // (q + l w) lies on the shell: y does not change with l, z does.
    const double z = std::sqrt(shell_mm * shell_mm - q.y() * q.y());
    seam::SeamPoint point;
    point.p_base = q + (z - q.z()) / w.z() * w;
    point.n_shell = Eigen::Vector3d(0.0, point.p_base.y(), point.p_base.z()) / shell_mm;
    point.n_nozzle = radial;
    point.tangent = point.n_shell.cross(point.n_nozzle).normalized();
    const Eigen::Vector3d side = point.n_shell.cross(point.n_nozzle);
    point.dihedral_rad =
        std::numbers::pi - std::atan2(side.norm(), point.n_shell.dot(point.n_nozzle));
    point.confidence = seam::Confidence::kHigh;
    point.source = seam::Source::kMeasured;
    return point;
  }

  /// `count` points once round, counter-clockwise seen from outside.
  [[nodiscard]] std::vector<seam::SeamPoint> points(std::size_t count) const {
    std::vector<seam::SeamPoint> all;
    double s = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      all.push_back(
          at(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count)));
      if (i > 0) {
        s += (all[i].p_base - all[i - 1].p_base).norm();
      }
      all[i].s_mm = s;
    }
    return all;
  }

  /// The angle on the nozzle at which the seam passes nearest to `p`.
  [[nodiscard]] double angle_of(const Eigen::Vector3d& p) const {
    const double lean = std::numbers::pi / 2.0 - axes_rad;
    const Eigen::Vector3d u(std::cos(lean), 0.0, -std::sin(lean));
    return std::atan2(p.y() - eccentric_mm, p.dot(u));
  }

  /// Arc length of the whole seam, by brute force.
  [[nodiscard]] double length_mm() const {
    double s = 0.0;
    constexpr int kSteps = 200000;
    Eigen::Vector3d before = at(0.0).p_base;
    for (int i = 1; i <= kSteps; ++i) {
      const Eigen::Vector3d p = at(2.0 * std::numbers::pi * i / kSteps).p_base;
      s += (p - before).norm();
      before = p;
    }
    return s;
  }
};

[[nodiscard]] inline seam::SeamView view_of(const std::vector<seam::SeamPoint>& points) {
  seam::SeamView view;
  view.points = points;
  view.length_mm = points.back().s_mm + (points.front().p_base - points.back().p_base).norm();
  return view;
}

}  // namespace dseam::test
