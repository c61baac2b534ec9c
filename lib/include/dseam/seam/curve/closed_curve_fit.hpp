// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/seam/seam_report.hpp"

namespace dseam::seam {

/// A closed curve through unordered points of a seam, and the two surfaces that they lie on.
///
/// A periodic series of order six in each coordinate; every point's parameter is moved to its foot
/// on the curve until the distances are orthogonal. Residuals are told apart by direction: what
/// is along the shell and across the seam misplaces a weld, and a surface's R-squared hides it.
///
/// Frame:   that of the points.
/// Memory:  `bytes()` from the arena.
/// Time:    O(points), a fixed number of rounds.
class ClosedCurveFit {
 public:
  static constexpr std::size_t kHarmonics = 6;
  static constexpr std::size_t kCoefficients = 2 * kHarmonics + 1;  ///< Of each axis.

  struct Report {
    Refusal refusal = Refusal::kEmptyCloud;
    std::uint32_t num_points = 0;
    std::uint32_t num_outliers = 0;  ///< Further off than eight robust sigmas; not fitted.
    double length_mm = 0.0;
    double largest_hole_rad = 0.0;
    double largest_hole_mm = 0.0;
    ResidualStats orthogonal;
    ResidualStats lateral;
    ResidualStats normal;
    Eigen::Vector3d rms_mm = Eigen::Vector3d::Zero();  ///< Of each axis.
    Eigen::Vector3d r_squared = Eigen::Vector3d::Zero();
    Surface shell;
    Surface nozzle;
    double shell_rms_mm = 0.0;
    double nozzle_rms_mm = 0.0;
    double axes_angle_rad = 0.0;
    double axes_offset_mm = 0.0;
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_points) noexcept {
    return Arena::bytes<Station>(max_points) + Arena::bytes<double>(max_points) +
           Arena::bytes<Work>(1);
  }
  ClosedCurveFit(std::size_t max_points, Arena& arena) noexcept
      : stations_(arena.take<Station>(max_points)),
        sorted_(arena.take<double>(max_points)),
        work_(arena.take<Work>(1)) {}

  /// Writes the curve at even steps, counter-clockwise about the nozzle as seen from its free end.
  Report run(std::span<const Eigen::Vector3d> points, double point_spacing_mm,
             Buffer<SeamPoint>& out) noexcept;

 private:
  using Basis = std::array<double, kCoefficients>;
  struct Station {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    double t_rad = 0.0;
    double off_mm = 0.0;
    bool used = true;
  };
  static constexpr std::size_t kSteps = 1024;
  struct Work {
    std::array<double, kCoefficients * kCoefficients> normal{};
    std::array<Basis, 3> series{};
    std::array<double, kSteps + 1> lengths{};
    std::array<bool, kSteps> seen{};  // Steps of the parameter at which a used point lies.
  };
  struct Jet {
    Eigen::Vector3d p, d1, d2;
  };

  bool lay_out(std::span<const Eigen::Vector3d> points, Report& report) noexcept;
  bool fit_series() noexcept;
  void move_to_feet() noexcept;
  void reject_outliers(Report& report) noexcept;
  bool fit_surfaces(Report& report) noexcept;
  double fit_surface(Surface& surface) const noexcept;
  void fit_shell(Report& report) const noexcept;
  void describe(Report& report) noexcept;
  void find_hole(Report& report) noexcept;
  void write_curve(double spacing_mm, Report& report, Buffer<SeamPoint>& out) noexcept;
  void mark_seen() noexcept;
  [[nodiscard]] double hole_at(std::size_t step) const noexcept;
  [[nodiscard]] Jet at(double t_rad) const noexcept;
  [[nodiscard]] ResidualStats stats_of(std::size_t count) noexcept;

  std::span<Station> stations_;
  std::span<double> sorted_;
  std::span<Work> work_;
  std::size_t count_ = 0;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();
};

}  // namespace dseam::seam
