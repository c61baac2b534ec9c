// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/seam/surface/surface.hpp"

namespace dseam::seam {

enum class OpenKind : std::uint8_t {
  kFillet,  ///< Two surfaces meet at an angle, as where a plate stands on a plate.
  kButt,    ///< Two plates lie edge to edge with a gap between them.
};

/// Two surfaces that meet in an open seam. Side 0 is the larger one, the shell of the reports.
///
/// Shape:   `air_sign` is the sign of a surface's signed distance in the air; `seam_sign` that of
///          the other surface's signed distance on this side (fillet), or of the coordinate across
///          the gap (butt).
struct OpenJoint {
  OpenKind kind = OpenKind::kFillet;
  std::array<Surface, 2> surface;
  std::array<double, 2> air_sign{1.0, 1.0};
  std::array<double, 2> seam_sign{1.0, 1.0};
  Eigen::Vector3d across = Eigen::Vector3d::UnitY();  ///< Butt: from the middle of the gap...
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();   ///< ...which passes through here.

  /// Height of a point above one of the surfaces.
  [[nodiscard]] double off(std::size_t side, const Eigen::Vector3d& p) const noexcept;
  /// Distance of a point of one side from the seam, along that side.
  [[nodiscard]] double away(std::size_t side, const Eigen::Vector3d& p) const noexcept;
  [[nodiscard]] Eigen::Vector3d normal(std::size_t side, const Eigen::Vector3d& p) const noexcept;
};

/// The point nearest to `p` that lies on both surfaces; nothing where they run alongside.
[[nodiscard]] std::optional<Eigen::Vector3d> onto_both(const Surface& a, const Surface& b,
                                                       const Eigen::Vector3d& p) noexcept;
/// The direction in which two surfaces meet at a point of both.
[[nodiscard]] Eigen::Vector3d meeting_direction(const Surface& a, const Surface& b,
                                                const Eigen::Vector3d& p) noexcept;

/// Even steps along an open seam, and where beside them a point lies.
///
/// Memory:  `bytes()` from the arena.
class SeamTrack {
 public:
  static constexpr std::size_t kMaxStations = 1024;
  struct Station {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();
    double s_mm = 0.0;
  };

  [[nodiscard]] static constexpr std::size_t bytes() noexcept {
    return Arena::bytes<Station>(kMaxStations);
  }
  SeamTrack() = default;
  explicit SeamTrack(Arena& arena) noexcept : stations_(arena.take<Station>(kMaxStations)) {}

  void clear() noexcept { stations_.clear(); }
  void copy(const SeamTrack& other) noexcept;
  [[nodiscard]] bool append(const Eigen::Vector3d& p) noexcept {
    return stations_.append({p, Eigen::Vector3d::UnitX(), 0.0});
  }
  /// Turns the order round.
  void reverse() noexcept;
  /// Keeps stations `first` to `last`.
  void trim(std::size_t first, std::size_t last) noexcept;
  /// Moves every station onto both surfaces; false where one finds no place on them.
  [[nodiscard]] bool lay_onto(const Surface& a, const Surface& b) noexcept;
  /// Tangents and arc lengths, when all stations are in.
  void finish() noexcept;

  [[nodiscard]] std::span<const Station> stations() const noexcept { return stations_.view(); }
  [[nodiscard]] double length_mm() const noexcept {
    return stations_.empty() ? 0.0 : stations_.view().back().s_mm;
  }
  /// Arc length of the foot of `p`; beyond the ends along the end's tangent.
  [[nodiscard]] double s_of(const Eigen::Vector3d& p) const noexcept;
  /// The place at an arc length, and straight on beyond the ends.
  [[nodiscard]] Station at(double s_mm) const noexcept;

 private:
  Buffer<Station> stations_;
};

}  // namespace dseam::seam
