// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/seam/joint/joint.hpp"
#include "dseam/seam/joint/residual_model.hpp"

namespace dseam::seam {

/// A point of the cloud near the joint, on one of its two surfaces.
struct NearPoint {
  Eigen::Vector3f from_pivot;
  double phi_rad = 0.0;
  double away_mm = 0.0;      ///< Distance from the other surface.
  double distance_mm = 0.0;  ///< From the fitted surface...
  double rest_mm = 0.0;      ///< ...and from the surface with its deviation.
  bool trusted = false;      ///< Within the robust cut of the fitted surface.
};

/// Refines the two surfaces of a joint on the points near it, and models how they deviate there.
///
/// Points within two spacings of the other surface are left out: a voxel's mean mixes both there.
/// Tacks and spatter are rejected by Tukey's weight about the fitted surface.
///
/// Frame:   that of the cloud.
/// Memory:  `bytes()` from the arena.
class JointFit {
 public:
  /// Of the cloud's points: their distance, their scatter, and how far one may lie off its surface.
  struct Scales {
    double spacing_mm = 0.0;
    double noise_mm = 0.0;
    double tolerance_mm = 0.0;
  };
  /// One of the two surfaces near the joint.
  struct Side {
    Buffer<NearPoint> points;
    ResidualModel residual;
    bool fitted = false;
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_points) noexcept {
    return 2 * (Arena::bytes<NearPoint>(max_points / 2) + ResidualModel::bytes()) +
           Arena::bytes<float>(max_points / 2) + Arena::bytes<PatchSum>(kMaxPatches) +
           Arena::bytes<Patch>(kMaxPatches);
  }
  JointFit() = default;
  JointFit(std::size_t max_points, Arena& arena) noexcept;

  /// False when one of the surfaces has too few points near the joint.
  ///
  /// `bore` is the inside of the nozzle's wall, if it was seen: its points are not the outside's.
  bool run(const cloud::CloudView& cloud, const Joint& found, const std::optional<Surface>& bore,
           const Scales& scales) noexcept;

  [[nodiscard]] const Joint& joint() const noexcept { return joint_; }
  [[nodiscard]] const NozzleFrame& frame() const noexcept { return frame_; }
  [[nodiscard]] double band_mm() const noexcept { return band_mm_; }
  [[nodiscard]] const Eigen::Vector3d& pivot() const noexcept { return pivot_; }
  [[nodiscard]] const Side& shell() const noexcept { return shell_; }
  [[nodiscard]] const Side& nozzle() const noexcept { return nozzle_; }

  /// Points for which there was no room.
  [[nodiscard]] std::uint32_t num_dropped() const noexcept { return num_dropped_; }

  /// Distance of a point from the fitted shell or nozzle, deviation included.
  [[nodiscard]] double above_shell(const Eigen::Vector3d& p) const noexcept;
  [[nodiscard]] double outside_nozzle(const Eigen::Vector3d& p) const noexcept;
  [[nodiscard]] double shell_variance(const Eigen::Vector3d& p) const noexcept;
  [[nodiscard]] double nozzle_variance(const Eigen::Vector3d& p) const noexcept;
  /// The nozzle's error as a sum of independent ones, mm.
  [[nodiscard]] ResidualModel::Row nozzle_errors(const Eigen::Vector3d& p) const noexcept;

 private:
  struct PatchSum {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double away = 0.0;
    double distance = 0.0;
    double weight = 0.0;
  };

  void select(const cloud::CloudView& cloud, double tolerance_mm) noexcept;
  [[nodiscard]] bool deviates(double limit_mm) const noexcept;
  void add(const Eigen::Vector3d& p, double outside, double above, bool to_shell) noexcept;
  void measure(Side& side, const Surface& surface) const noexcept;
  bool refine(Side& side, Surface& surface) noexcept;
  void model(Side& side, Surface& surface) noexcept;
  double cut_of(const Side& side) noexcept;
  std::size_t collect_patches(const Side& side, double cut_mm) noexcept;

  [[nodiscard]] bool in_bore(const Eigen::Vector3d& p, double outside) const noexcept;

  Joint joint_;
  std::optional<Surface> bore_;
  NozzleFrame frame_;
  Eigen::Vector3d pivot_ = Eigen::Vector3d::Zero();
  double band_mm_ = 0.0;
  double inner_mm_ = 0.0;
  std::size_t patches_round_ = 1;
  std::uint32_t num_dropped_ = 0;
  bool follows_model_ = false;
  Side shell_;
  Side nozzle_;
  std::span<float> scratch_;
  std::span<PatchSum> sums_;
  std::span<Patch> patches_;
};

}  // namespace dseam::seam
