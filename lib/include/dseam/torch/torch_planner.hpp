// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/seam/seam_curve.hpp"
#include "dseam/torch/torch_path.hpp"

namespace dseam::torch {

/// Puts the torch over the seam: work angle from the local dihedral, travel angle, clearance,
/// tilt limit, and whether it may weld there.
///
/// Tangent and normals are smoothed by a local quadratic, which leaves a joint's own variation
/// alone; positions are not touched.
///
/// Frame:   base, as the seam.
/// Memory:  bytes(max_seam_points) of the arena.
/// Time:    O((seam points + torch points) * points within the smoothing window).
/// Context: one thread at a time; no heap, lock or system call.
/// Source:  AWS A3.0 for work angle and travel angle; Savitzky and Golay 1964 for the smoothing.
class TorchPlanner {
 public:
  struct Config {
    bool reversed = false;           ///< Travel against the order of the seam's points.
    double step_mm = 0.5;            ///< Distance between torch points at most.
    double smoothing_mm = 6.0;       ///< Half width of the window for tangent and normals.
    double work_fraction = 0.5;      ///< Wire's angle over the shell as a share of the dihedral.
    double work_offset_rad = 0.0;    ///< Added to it, towards the nozzle.
    double travel_angle_rad = 0.0;   ///< Positive pushes (the wire points ahead), negative drags.
    double stick_out_mm = 15.0;      ///< From the contact tip to the wire's end.
    double tip_radius_mm = 4.0;      ///< Of the contact tip.
    double min_clearance_mm = 1.0;   ///< Of the contact tip to either surface.
    double min_dihedral_rad = 0.5;   ///< The joint must be at least this open,
    double max_dihedral_rad = 2.62;  ///< and at most this.
    double max_gap_mm = 6.0;
    Eigen::Vector3d up_base = Eigen::Vector3d::UnitZ();
    double max_tilt_rad = std::numbers::pi;  ///< Of the torch's body from `up_base`.
    double max_work_error_rad = 0.0873;      ///< What the tilt limit may take from the work angle.
    double max_turn_rad_per_mm = 0.109;      ///< 0.5 degree at 100 Hz and 8 mm/s.
    seam::Confidence min_confidence = seam::Confidence::kLow;
    bool weld_interpolated = false;
  };
  enum class State : std::uint8_t {
    kPlanned,
    kNoSeam,    ///< Under four usable points, or no length.
    kBadPoint,  ///< A position is not finite, or two neighbours coincide.
    kTooLong,   ///< More seam points than make() was told of.
    kFull,      ///< The output has no room for the curve at this step.
  };
  struct Report {
    State state = State::kNoSeam;
    double length_mm = 0.0;
    double max_turn_rad_per_mm = 0.0;
    std::uint32_t points = 0;
    std::array<std::uint32_t, kNumWeldable> by_weldable{};  ///< Points by their `weldable`.
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_seam_points) noexcept {
    return Arena::bytes<Station>(max_seam_points + 1);
  }
  /// Errors:  kInvalidArgument: a value that is not finite or out of range. kOutOfMemory.
  [[nodiscard]] static Result<TorchPlanner> make(const Config& config, std::size_t max_seam_points,
                                                 Arena& arena) noexcept;

  /// The curve itself is `TorchCurveView{out.view(), report.length_mm, seam.closed}`.
  Report run(const seam::SeamView& seam, Buffer<TorchPoint>& out) noexcept;

 private:
  /// One seam point in the direction of travel, with what interpolation between it needs.
  struct Station {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector3d dp = Eigen::Vector3d::Zero();  ///< dp/dchord.
    double chord_mm = 0.0;
    double s_mm = 0.0;
    std::uint32_t source = 0;  ///< Index into the seam.
  };
  struct Joint {
    Eigen::Vector3d tangent = Eigen::Vector3d::Zero();
    Eigen::Vector3d n_shell = Eigen::Vector3d::Zero();
    Eigen::Vector3d n_nozzle = Eigen::Vector3d::Zero();
  };

  TorchPlanner(const Config& config, std::span<Station> stations) noexcept
      : config_(config), stations_(stations) {}
  State lay_stations(const seam::SeamView& seam) noexcept;
  void set_slopes() noexcept;
  void measure() noexcept;
  std::size_t num_segments() const noexcept { return closed_ ? size_ : size_ - 1; }
  Joint smoothed_joint(const seam::SeamView& seam, std::size_t near,
                       double chord_mm) const noexcept;
  TorchPoint point_at(const seam::SeamView& seam, std::size_t segment, double s_mm) const noexcept;
  bool orient(Joint joint, TorchPoint& point, double& work_error_rad) const noexcept;
  Weldable judge(const seam::SeamPoint& nearest, const TorchPoint& point,
                 double work_error_rad) const noexcept;
  void limit_turns(std::span<TorchPoint> points, Report& report) const noexcept;

  Config config_;
  std::span<Station> stations_;
  std::size_t size_ = 0;  ///< Seam points; a closed curve has one station more, like the first.
  bool closed_ = true;
};

}  // namespace dseam::torch
