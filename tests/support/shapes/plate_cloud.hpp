// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "dseam/cloud/cloud.hpp"

namespace dseam::test {

/// Two plates that meet in an open seam, as points straight from the formulas: no `lib/` code.
///
/// Frame:   part: the seam runs along x at z = 0, its middle at the origin; up is z. A fillet's
///          plate stands in y = 0 and is seen from +y; a butt's plates lie at z = 0 on both sides.
struct PlateCloudConfig {
  enum class Kind : std::uint8_t { kFillet, kButt };

  std::uint64_t seed = 1;
  Kind kind = Kind::kFillet;
  double length_mm = 200.0;
  double width_mm = 60.0;        ///< Of a plate beside the seam.
  double height_mm = 60.0;       ///< Of the standing plate.
  double lean_rad = 0.0;         ///< Of the standing plate from upright, towards +y.
  double curve_radius_mm = 0.0;  ///< Of the standing plate; positive bulges to +y; 0: flat.
  double gap_mm = 0.0;           ///< Between the plates' edges; under a fillet's standing plate.
  double step_mm = 0.0;          ///< How much lower a butt's second plate lies.
  double bow_mm = 0.0;           ///< The first plate's middle hangs this much under its ends.
  double second_face_mm =
      0.0;  ///< Thickness of a standing plate seen from both sides; 0: from one.
  double unseen_from_mm = 0.0;  ///< Along x, nothing from here...
  double unseen_to_mm = 0.0;    ///< ...to here.
  double dead_band_mm = 0.0;
  double spacing_mm = 1.0;
  double noise_mm = 0.02;
};

class PlateCloud {
 public:
  explicit PlateCloud(const PlateCloudConfig& config);

  [[nodiscard]] cloud::FusedCloudView view() const { return {{x_, y_, z_}, {}, {}}; }
  void add(const Eigen::Vector3d& p);
  /// A box with its top and sides, as a clamp's jaw.
  void add_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high);
  void transform(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& shift, double scale);

  /// The true root of a fillet, or middle of a butt's gap, `s_mm` from the seam's middle.
  [[nodiscard]] Eigen::Vector3d seam_at(double s_mm) const;
  /// Distance of `p` from the true seam, which goes straight on beyond its ends.
  [[nodiscard]] double distance(const Eigen::Vector3d& p) const;

 private:
  /// A plate from `from_mm` to `to_mm` beside the seam.
  void add_plate(bool standing, double from_mm, double to_mm, double side);
  [[nodiscard]] Eigen::Vector3d on_plate(bool standing, double s_mm, double away_mm,
                                         double side) const;
  double jitter();

  PlateCloudConfig config_;
  std::mt19937_64 random_;
  std::vector<float> x_, y_, z_;
};

}  // namespace dseam::test
