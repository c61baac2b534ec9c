// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "dseam/depth/depth_image.hpp"
#include "dseam/geometry/rigid_transform.hpp"
#include "dseam/markers/marker.hpp"
#include "lib/markers/dot_grid.hpp"

namespace dseam::test {

/// A square grid of dots, one corner dot larger than the rest: it makes the four turns of the grid
/// differ. Frame `target`: its origin in the larger dot, x and y along the grid, z away from the
/// camera.
class DotTarget {
 public:
  DotTarget(int dots_a_side, double pitch_mm, const depth::Intrinsics& camera)
      : side_(dots_a_side), pitch_mm_(pitch_mm), camera_(camera) {}

  /// Where the target is, by least squares in the image; nothing unless the whole grid was found.
  std::optional<geometry::RigidTransform> T_camera_target(
      const std::vector<markers::Marker>& dots) const {
    std::vector<Eigen::Vector2d> centres;
    for (const markers::Marker& dot : dots) {
      centres.emplace_back(dot.u, dot.v);
    }
    const std::optional<DotGrid> grid = turned(GridGrower(centres).largest(), dots);
    return grid ? std::optional(refined(*grid, centres)) : std::nullopt;
  }

 private:
  /// The grid with the larger dot at (0, 0).
  std::optional<DotGrid> turned(const DotGrid& grid,
                                const std::vector<markers::Marker>& dots) const {
    Eigen::Vector2i low = Eigen::Vector2i::Constant(1 << 20);
    Eigen::Vector2i high = -low;
    GridPlace large{};
    double radius_px = 0.0;
    for (const auto& [place, k] : grid) {
      low = low.cwiseMin(Eigen::Vector2i(place.first, place.second));
      high = high.cwiseMax(Eigen::Vector2i(place.first, place.second));
      if (dots[k].ellipse.a > radius_px) {
        radius_px = dots[k].ellipse.a;
        large = place;
      }
    }
    const bool right = large.first == high.x();
    const bool top = large.second == high.y();
    if (high.x() - low.x() + 1 != side_ || high.y() - low.y() + 1 != side_ ||
        (!right && large.first != low.x()) || (!top && large.second != low.y())) {
      return std::nullopt;
    }
    DotGrid out;
    for (const auto& [place, k] : grid) {
      const int x = right ? high.x() - place.first : place.first - low.x();
      const int y = top ? high.y() - place.second : place.second - low.y();
      out[right == top ? GridPlace{x, y} : GridPlace{y, x}] = k;
    }
    return out;
  }

  struct Fit {
    geometry::RigidTransform pose;
    double squares_px2 = std::numeric_limits<double>::infinity();
  };

  /// The best of Gauss-Newton from five leans: a plane nearly has two poses.
  geometry::RigidTransform refined(const DotGrid& grid,
                                   const std::vector<Eigen::Vector2d>& centres) const {
    constexpr double kLeanRad = 0.6;
    const geometry::RigidTransform flat = facing(grid, centres);
    Fit best;
    for (const auto& [x, y] : {GridPlace{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const geometry::RigidTransform lean{
          geometry::rotation_exp({x * kLeanRad, y * kLeanRad, 0.0})};
      const Fit fit = fitted({lean.rotation * flat.rotation, flat.translation_mm}, grid, centres);
      if (fit.squares_px2 < best.squares_px2) {
        best = fit;
      }
    }
    return best.pose;
  }

  Fit fitted(const geometry::RigidTransform& start, const DotGrid& grid,
             const std::vector<Eigen::Vector2d>& centres) const {
    Fit fit{start};
    for (int round = 0; round < 30; ++round) {
      geometry::Matrix6 normal = geometry::Matrix6::Zero();
      geometry::Vector6 gradient = geometry::Vector6::Zero();
      fit.squares_px2 = 0.0;
      for (const auto& [place, k] : grid) {
        const Eigen::Vector3d p = fit.pose * on_target(place);
        Eigen::Matrix<double, 2, 3> by_point;
        by_point << camera_.fx / p.z(), 0.0, -camera_.fx * p.x() / (p.z() * p.z()),  //
            0.0, camera_.fy / p.z(), -camera_.fy * p.y() / (p.z() * p.z());
        Eigen::Matrix<double, 3, 6> by_pose;
        by_pose << Eigen::Matrix3d::Identity(), -geometry::skew(p);
        const Eigen::Matrix<double, 2, 6> j = by_point * by_pose;
        const Eigen::Vector2d off = seen_at(p) - centres[k];
        normal += j.transpose() * j;
        gradient += j.transpose() * off;
        fit.squares_px2 += off.squaredNorm();
      }
      fit.pose = geometry::perturbed(fit.pose, -normal.ldlt().solve(gradient));
    }
    return fit;
  }

  geometry::RigidTransform facing(const DotGrid& grid,
                                  const std::vector<Eigen::Vector2d>& centres) const {
    const Eigen::Vector2d origin = centres[grid.at({0, 0})];
    const Eigen::Vector2d along = centres[grid.at({side_ - 1, 0})] - origin;
    const double z_mm = camera_.fx * pitch_mm_ * (side_ - 1) / along.norm();
    const double turn_rad = std::atan2(along.y(), along.x());
    return {geometry::rotation_exp({0.0, 0.0, turn_rad}),
            {(origin.x() - camera_.cx) * z_mm / camera_.fx,
             (origin.y() - camera_.cy) * z_mm / camera_.fy, z_mm}};
  }

  Eigen::Vector3d on_target(const GridPlace& place) const {
    return {pitch_mm_ * place.first, pitch_mm_ * place.second, 0.0};
  }
  Eigen::Vector2d seen_at(const Eigen::Vector3d& p) const {
    return {camera_.cx + camera_.fx * p.x() / p.z(), camera_.cy + camera_.fy * p.y() / p.z()};
  }

  int side_;
  double pitch_mm_;
  depth::Intrinsics camera_;
};

}  // namespace dseam::test
