// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/geometry/cylinder_fit.hpp"
#include "dseam/splice/pipes/pipe_pair.hpp"
#include "dseam/splice/surface_patches.hpp"

namespace dseam::test {

/// A pipe's outside between two places along its axis; an ovality makes the radius
/// r + ovality cos(2 phi), phi from the base's first direction on.
struct ScenePipe {
  geometry::Cylinder cylinder;
  double from_mm = 0.0;
  double to_mm = 0.0;
  double ovality_mm = 0.0;
};

/// Shell (along x, its axis in the origin) and nozzle of a part, and more.
struct PipeScene {
  std::vector<ScenePipe> pipes;
  bool plate = false;  ///< The plane z = 60 of the part.
};
[[nodiscard]] ScenePipe shell_of(double radius_mm);
/// At `along_mm` of the shell, leaning towards +x by 90 degrees less `angle_rad`.
[[nodiscard]] ScenePipe nozzle_of(double radius_mm, double angle_rad, double eccentricity_mm,
                                  double along_mm = 0.0);

/// A camera's pose in the part's frame: from `azimuth_rad`, 45 degrees high, at the joint.
[[nodiscard]] geometry::RigidTransform look_from(double azimuth_rad);

/// The patches of a view, in closed form but for their noise.
class PatchView {
 public:
  /// Frames of half the scanner's size, or the whole size.
  PatchView(const PipeScene& scene, const geometry::RigidTransform& T_part_camera,
            bool whole_size = false);
  [[nodiscard]] splice::PatchField field() const;
  /// The same with normal errors of each patch's height; its slopes are off by half as much.
  [[nodiscard]] PatchView noisy(double sigma_mm, Pcg32& random) const;

 private:
  depth::Intrinsics intrinsics_;
  std::vector<splice::SurfacePatch> patches_;
};

[[nodiscard]] splice::PipePair find_pipes(const splice::PatchField& field);

}  // namespace dseam::test
