// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dseam/hal/sim/cell_config.hpp"
#include "dseam/hal/sim/solid.hpp"

namespace dseam::hal::sim {

/// What a pixel sees.
enum class Surface : std::uint8_t {
  kNothing,
  kShell,         ///< Its outside.
  kShellInside,   ///< Hole walls, inner surface, ends.
  kNozzle,        ///< Its outside.
  kNozzleInside,  ///< Bore, rim, lower end.
  kTable,
  kFixture,
  kSecondNozzle,
  kTackWeld,
  kSpatter,
};

/// One solid of the cell and what it looks like.
struct Body {
  Solid solid;
  Surface outside = Surface::kFixture;  ///< Seen on `outer_face` of the first part...
  Surface inside = Surface::kFixture;   ///< ...and everywhere else.
  std::uint8_t outer_face = 0;
  double albedo = 0.4;
};

/// The first surface that a ray meets.
struct SceneHit {
  double t = std::numeric_limits<double>::infinity();
  std::uint16_t body = 0;
  SolidHit on_body;

  [[nodiscard]] bool any() const noexcept { return t < std::numeric_limits<double>::infinity(); }
};

/// All solids of the cell and the marker discs, in closed form: no mesh anywhere.
///
/// Frame:   part.
struct Scene {
  std::vector<Body> bodies;
  std::vector<Eigen::Vector3d> markers;  ///< Centres of the discs, on the shell's outside.
  std::vector<Eigen::Vector3d> marker_normals;

  [[nodiscard]] SceneHit cast(const Ray& ray,
                              std::span<const std::uint16_t> candidates) const noexcept;
  [[nodiscard]] SceneHit cast(const Ray& ray) const noexcept;
  [[nodiscard]] Surface surface(const SceneHit& hit) const noexcept;
  /// Outward unit normal at `p`, a point of `hit`.
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& p,
                                       const SceneHit& hit) const noexcept;
  /// Distance from `p` to the centre of the nearest marker disc; infinity without markers.
  [[nodiscard]] double marker_distance(const Eigen::Vector3d& p) const noexcept;
};

/// Builds the cell's solids; the places of markers and clutter are drawn from the seed.
[[nodiscard]] Scene make_scene(const CellConfig& config);

}  // namespace dseam::hal::sim
