// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/splice/block_system.hpp"
#include "dseam/splice/spliced_view.hpp"
#include "dseam/splice/surface_patches.hpp"

namespace dseam::splice {

/// What one view brings into the adjustment.
struct NetworkView {
  PatchField field;
  ReportedPose reported;
  geometry::RigidTransform start_T_base_camera;  ///< Good to a few millimetres.
  bool placed = false;                           ///< False: no start is known; left out.
};

/// One sight of a marker: the same `landmark` in several views is the same disc.
struct MarkerSight {
  std::uint16_t view = 0;
  std::uint16_t landmark = 0;
  Eigen::Vector3d p_camera = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_mm2 = Eigen::Matrix3d::Identity();
};

enum class NetworkState : std::uint8_t {
  kAdjusted,
  kNoViews,       ///< None was given, or those that are left contradict each other.
  kOneView,       ///< There is nothing to adjust; the view stands as reported.
  kNotConverged,  ///< The last step was still large after the last iteration.
  kSingular,      ///< A direction is free in all views together.
};

struct NetworkReport {
  NetworkState state = NetworkState::kNoViews;
  std::uint32_t iterations = 0;
  std::uint32_t num_used = 0;
  std::uint32_t num_left_out = 0;
  std::uint32_t num_markers = 0;           ///< Landmarks seen by two used views or more.
  std::uint32_t num_markers_rejected = 0;  ///< Sights that contradict their landmark.
  std::uint32_t num_surface_ties = 0;
  double surface_sigma_mm = 0.0;      ///< Of one patch in one view, after the adjustment.
  double ties_per_independent = 1.0;  ///< How many ties share one independent error.
  Eigen::Vector2d bowl_mm = Eigen::Vector2d::Zero();  ///< Depth error at the image's sides, found.
  bool has_base = false;  ///< False: the frame is the first used view's camera.
  /// What all views have in common, as a left perturbation about the base origin.
  geometry::Matrix6 base_covariance = geometry::Matrix6::Zero();
};

/// How the errors of all views hang together, about their mean: the blocks on the diagonal are
/// `SplicedView::covariance`.
///
/// Frame:   base, as there.
/// Memory:  lent by the network until its next run().
struct JointCovariance {
  static constexpr std::size_t kCells = 36 * cloud::kMaxViews * cloud::kMaxViews;
  std::span<double> cells;

  [[nodiscard]] Eigen::Map<geometry::Matrix6> at(std::size_t v, std::size_t w) const noexcept {
    return Eigen::Map<geometry::Matrix6>(cells.data() + 36 * (v * cloud::kMaxViews + w));
  }
};

/// One adjustment of all views: surface against surface wherever views overlap, markers as points
/// in space, the robot's poses with their errors, and the scanner's depth bowl as an unknown that
/// all views share.
///
/// Every patch that several views see is one unknown height along its normal, eliminated on the
/// spot; a marker is one unknown point. What remains are six unknowns a view, and the loop of views
/// around the workpiece closes by itself. A motion of a view that its ties know less of than its
/// report is left to the report. Nothing is assumed of the surface's shape, and pixels of
/// two views need no search: a patch is projected into the other image.
///
/// Frame:   base, in the sense of docs/architecture.md: the least-squares fit to the reported
///          poses; without any, the first used view's camera.
/// Memory:  from the arena; 6x6 blocks for `cloud::kMaxViews` views at most.
/// Time:    O(patches x views) an iteration, a bounded number of iterations.
/// Errors:  states by name in the report and in each view; run() cannot fail.
class ViewNetwork {
 public:
  struct Config {
    double reported_sigma_mm = 1.0;  ///< Of each axis of a reported camera position.
    double reported_sigma_rad = 0.0052359877559829881;  ///< 0.3 degree.
    double bowl_sigma_mm = 0.01;    ///< Of the depth bowl at the image sides, beforehand.
    double offset_sigma_mm = 0.01;  ///< Of an error that all depths have in common.
    double start_gate_mm = 8.0;     ///< How far apart surfaces may be at first,
    double final_gate_mm = 0.25;    ///< and at last, unless the surface is noisier.
    double min_share_near = 0.5;    ///< Of a view's ties that must hold; fewer contradict.
    double max_sigma_mm = 0.5;      ///< Of a view at what is seen; more is kUnobservable.
    std::uint32_t max_iterations = 25;
  };

  [[nodiscard]] static constexpr std::size_t bytes() noexcept {
    return BlockSystem::bytes(kUnknowns) + Arena::bytes<PosedView>(cloud::kMaxViews) +
           Arena::bytes<geometry::Matrix6>(cloud::kMaxViews);
  }
  /// Errors:  kInvalidArgument, kOutOfMemory.
  [[nodiscard]] static Result<ViewNetwork> make(const Config& config, Arena& arena) noexcept;

  /// Views beyond `cloud::kMaxViews`, or beyond `out`, are not looked at.
  ///
  /// Shape:   `sights` is ordered by landmark.
  NetworkReport run(std::span<const NetworkView> views, std::span<const MarkerSight> sights,
                    Buffer<SplicedView>& out) noexcept;
  /// Of the views of the last run().
  [[nodiscard]] const JointCovariance& joint_covariance() const noexcept { return joint_; }

 private:
  static constexpr std::size_t kUnknowns = 6 * cloud::kMaxViews + 2;
  static_assert(JointCovariance::kCells <= kUnknowns * kUnknowns);
  explicit ViewNetwork(const Config& config) noexcept : config_(config) {}

  Config config_;
  BlockSystem system_;
  std::span<PosedView> posed_;
  std::span<geometry::Matrix6> tied_;
  JointCovariance joint_;
};

}  // namespace dseam::splice
