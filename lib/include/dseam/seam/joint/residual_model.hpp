// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/seam/joint/dense_solver.hpp"
#include "dseam/seam/joint/joint.hpp"
#include "dseam/seam/joint/patch_kinship.hpp"

namespace dseam::seam {

/// How far the real surface lies off its model near a joint, as a smooth function of the place.
///
/// Columns: the model's own parameters, the surface's ovality about its own axis, then harmonics
/// of the angle about the nozzle, constant and linear in the distance from the joint. How many of
/// them the points justify is decided by the Bayesian information criterion on patch means; their
/// number is that of the independent ones among them, as the rests of the simpler model show it.
/// Deviations are expected to be of the order of a millimetre, which damps what hardly any patch
/// speaks for.
///
/// Memory:  `bytes()` from the arena.
class ResidualModel {
 public:
  static constexpr std::size_t kOvalColumns = 4;
  static constexpr std::size_t kMaxHarmonics = 6;
  static constexpr std::size_t kHarmonicColumns = 2 * kMaxHarmonics + 1;
  static constexpr std::size_t kColumns =
      kMaxSurfaceParameters + kOvalColumns + 2 * kHarmonicColumns;
  using Row = std::array<double, kColumns>;

  [[nodiscard]] static constexpr std::size_t bytes() noexcept {
    return 2 * Arena::bytes<double>(kColumns * kColumns) + Arena::bytes<Fitted>(1);
  }
  ResidualModel() = default;
  explicit ResidualModel(Arena& arena) noexcept
      : normal_(arena.take<double>(kColumns * kColumns)),
        factor_(arena.take<double>(kColumns * kColumns)),
        fitted_(arena.take<Fitted>(1)) {}

  /// Forgets everything: the residual is 0 until fit().
  void reset(const Surface& surface) noexcept;
  /// Chooses the order and fits; false where there are too few patches for the model itself.
  bool fit(std::span<const Patch> patches, const PatchGrid& grid) noexcept;

  [[nodiscard]] double at(const Eigen::Vector3d& p, double phi_rad, double away) const noexcept;
  /// The error of at() as a sum of independent ones, mm, from the scatter of the patches.
  [[nodiscard]] Row errors_at(const Eigen::Vector3d& p, double phi_rad, double away) const noexcept;
  /// Their squares' sum.
  [[nodiscard]] double variance_at(const Eigen::Vector3d& p, double phi_rad,
                                   double away) const noexcept;
  /// The highest harmonic in use; -1: the model alone.
  [[nodiscard]] int harmonics() const noexcept { return fitted_[0].harmonics; }
  /// Takes the change of the model's own parameters out of the residual; the surface after it.
  [[nodiscard]] Surface move_into(const Surface& surface) noexcept;

 private:
  struct Order {
    bool oval = false;
    int constant = -1;  // Harmonics; -1: not even a constant.
    int linear = -1;
  };
  struct Columns {
    std::array<std::size_t, kColumns> index{};
    std::size_t count = 0;
  };
  // How many patches tell no more than one: for the choice of the order, and for the errors.
  struct InOne {
    double of_choice = 1.0;
    double of_errors = 1.0;
  };
  struct Fitted {
    Surface surface;
    Row right{};
    Row solution{};
    Columns columns;
    double squares = 0.0;       // Of the patches' distances, weighted.
    double damping = 0.0;       // Of deviations: the rests' variance over that expected of them.
    double variance_mm2 = 0.0;  // Of a patch, and of those that err like it.
    int harmonics = -1;
    bool valid = false;
  };

  void row_at(const Eigen::Vector3d& p, double phi_rad, double away, Row& row) const noexcept;
  void accumulate(std::span<const Patch> patches) noexcept;
  [[nodiscard]] Columns columns_of(const Order& order) const noexcept;
  bool solve(const Columns& columns, Row& solution) noexcept;
  [[nodiscard]] double squares(const Columns& columns, const Row& solution) const noexcept;
  [[nodiscard]] InOne patches_in_one(std::span<const Patch> patches,
                                     const PatchGrid& grid) noexcept;

  std::span<double> normal_;
  std::span<double> factor_;
  std::span<Fitted> fitted_;
};

}  // namespace dseam::seam
