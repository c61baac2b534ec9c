// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

namespace dseam::hal::sim {

/// p = origin + t * direction. The scanner's directions have unit length along the optical axis,
/// so that t is the depth.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
};

/// Where a ray is inside a convex body, and through which faces it enters and leaves.
struct Crossing {
  double enter = std::numeric_limits<double>::infinity();
  double leave = -std::numeric_limits<double>::infinity();
  std::uint8_t enter_face = 0;
  std::uint8_t leave_face = 0;

  [[nodiscard]] bool hits() const noexcept { return enter < leave; }
};

/// A convex body with a closed-form ray crossing.
///
/// Frame:   its own: `axes` has the local axes as columns, `centre` the local origin.
struct Convex {
  enum class Kind : std::uint8_t {
    kTube,       ///< (x/a)^2 + (y/b)^2 <= (1 + taper z)^2, low <= z <= high.
    kEllipsoid,  ///< (x/a)^2 + (y/b)^2 + (z/c)^2 <= 1.
    kBox,        ///< |x| <= a, |y| <= b, |z| <= c.
  };

  Kind kind = Kind::kBox;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d half = Eigen::Vector3d::Ones();  ///< a, b, c.
  double taper = 0.0;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  [[nodiscard]] Crossing cross(const Ray& ray) const noexcept;
  /// The outward unit normal at a point of `face`.
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& p, std::uint8_t face) const noexcept;
  [[nodiscard]] bool contains(const Eigen::Vector3d& p) const noexcept;
};

/// The first point that a ray meets on a solid. `part` counts keep first, then cut.
struct SolidHit {
  double t = std::numeric_limits<double>::infinity();
  std::uint8_t part = 0;
  std::uint8_t face = 0;
};

/// What lies in every `keep` body and in no `cut` body.
///
/// Shape:   at most kMaxCuts cuts.
struct Solid {
  static constexpr std::size_t kMaxCuts = 16;

  std::vector<Convex> keep;
  std::vector<Convex> cut;
  Eigen::Vector3d bound_centre = Eigen::Vector3d::Zero();
  double bound_radius = std::numeric_limits<double>::infinity();

  [[nodiscard]] SolidHit cast(const Ray& ray) const noexcept;
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& p,
                                       const SolidHit& hit) const noexcept;
  [[nodiscard]] bool contains(const Eigen::Vector3d& p) const noexcept;
};

}  // namespace dseam::hal::sim
