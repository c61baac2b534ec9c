// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::splice {

/// What one scan says of the space in front of it, when its cloud is all that is left of it.
///
/// A scanner sees one surface along each ray: the direction in which the cloud's points hide each
/// other least is the one it was taken from, but for the sign. What another cloud would put before
/// the surface seen there contradicts it.
///
/// Frame:   the cloud's.
/// Memory:  two grids of kSide x kSide from the arena.
class FrontView {
 public:
  static constexpr std::size_t kSide = 96;
  static constexpr double kMaxHidden = 0.25;  ///< More, and it is no single scan.

  /// Shares of a cloud's points that lie before the surface, for either sign of the direction.
  struct Before {
    double plus = 0.0;
    double minus = 0.0;
  };

  [[nodiscard]] static constexpr std::size_t bytes() noexcept {
    return 2 * Arena::bytes<float>(kSide * kSide);
  }
  FrontView() = default;
  explicit FrontView(Arena& arena) noexcept
      : low_(arena.take<float>(kSide * kSide)), high_(arena.take<float>(kSide * kSide)) {}

  /// `scale_mm`: what spacing and noise leave unsure.
  ///
  /// Time:    O(points) for each of 300 directions, of at most 6000 points.
  void run(const cloud::CloudView& cloud, double scale_mm) noexcept;
  [[nodiscard]] bool known() const noexcept { return known_; }
  [[nodiscard]] const Eigen::Vector3d& direction() const noexcept { return direction_; }
  /// Neither share where the direction is not known.
  [[nodiscard]] Before before(const cloud::CloudView& other,
                              const geometry::RigidTransform& T_this_other) const noexcept;
  /// With the signs that were learnt, else the smaller share.
  [[nodiscard]] double contradiction(const Before& before) const noexcept;
  /// Learns the sign from a cloud that lies where it belongs.
  void learn(const Before& before) noexcept { sense_ += before.minus - before.plus; }

 private:
  struct Place {
    std::size_t bin = SIZE_MAX;  ///< SIZE_MAX: beside the grid.
    float depth = 0.0F;
  };
  void look_along(const Eigen::Vector3d& direction) noexcept;
  double fill(const cloud::CloudView& cloud) noexcept;
  [[nodiscard]] Place place(const Eigen::Vector3d& p) const noexcept;

  std::span<float> low_;
  std::span<float> high_;
  Eigen::Vector3d direction_ = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d right_ = Eigen::Vector3d::UnitX();
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitY();
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  double bin_mm_ = 1.0;
  double scale_mm_ = 1.0;
  double sense_ = 0.0;
  bool known_ = false;
};

}  // namespace dseam::splice
