// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/pipeline/surface_start.hpp"
#include "dseam/search/grid_index.hpp"
#include "dseam/splice/front_view.hpp"
#include "dseam/splice/icp.hpp"
#include "dseam/splice/spliced_view.hpp"

namespace dseam::pipeline {

/// What became of one cloud.
struct CloudSpliceRow {
  double agreement =
      0.0;             ///< With those placed before it: 1 on their surfaces, less what contradicts.
  double rival = 0.0;  ///< Of the best other place, as a share of `agreement`.
  double overlap = 0.0;          ///< Share of its points that meet others, in the end.
  double rms_mm = 0.0;           ///< Of these, across the surface.
  std::uint32_t num_frozen = 0;  ///< Motions that the surfaces do not show.
};

/// From clouds in frames of their own to one pose for each, with no guess beforehand.
///
/// A cloud's surfaces give places to start from, point-to-plane ICP onto all clouds placed before
/// sharpens each, and the best stands if no other comes near. In the end every cloud is registered
/// to all others, a few times over.
///
/// Frame:   that of the first cloud that is not empty.
/// Memory:  `bytes()` from the arena at make(); run() takes none.
/// Time:    O(clouds^2) searches at most.
/// Errors:  states by name for each cloud: kAmbiguous where another place fits as well, kNoOverlap
///          where none fits, kEmpty.
class CloudSpliceChain {
 public:
  struct Config {
    splice::LineSearch::Config search;
    double tolerance_mm = 3.0;    ///< Of a point to lie on another cloud, beside noise and spacing.
    double min_agreement = 0.35;  ///< Less is no overlap.
    double max_rival = 0.9;       ///< More is ambiguous.
    std::uint32_t num_rounds = 4;
  };
  struct Capacity {
    std::size_t max_clouds = cloud::kMaxViews;
    std::size_t max_points = 65536;  ///< Of what is registered; larger clouds are thinned to it.
  };

  [[nodiscard]] static std::size_t bytes(const Capacity& capacity) noexcept;
  /// Errors:  kInvalidArgument, kOutOfMemory.
  [[nodiscard]] static Result<CloudSpliceChain> make(const Config& config, const Capacity& capacity,
                                                     Arena& arena) noexcept;

  /// Clouds beyond the capacity, or beyond `out`, are not looked at. Returns how many stand.
  std::size_t run(std::span<const cloud::CloudView> clouds,
                  Buffer<splice::SplicedView>& out) noexcept;
  /// One entry a cloud of the last run.
  [[nodiscard]] std::span<const CloudSpliceRow> rows() const noexcept { return rows_.view(); }

 private:
  explicit CloudSpliceChain(const Config& config) noexcept : config_(config) {}
  void gather(std::span<const cloud::CloudView> clouds, std::span<const splice::SplicedView> views,
              std::size_t without) noexcept;
  void find_normals(double radius_mm) noexcept;
  [[nodiscard]] bool place(std::span<const cloud::CloudView> clouds, std::size_t which,
                           Buffer<splice::SplicedView>& out) noexcept;
  [[nodiscard]] splice::Icp::Report refine(const cloud::CloudView& source,
                                           const geometry::RigidTransform& start,
                                           double gate_mm) const noexcept;
  [[nodiscard]] double agreement(const cloud::CloudView& source,
                                 const geometry::RigidTransform& T_target_source) const noexcept;
  [[nodiscard]] double off_plane_mm(const Eigen::Vector3d& p_target, std::size_t i) const noexcept;
  [[nodiscard]] double score(std::span<const cloud::CloudView> clouds,
                             std::span<const splice::SplicedView> views, std::size_t which,
                             const geometry::RigidTransform& T_base_cloud) const noexcept;
  void learn_senses(std::span<const cloud::CloudView> clouds,
                    std::span<const splice::SplicedView> views, std::size_t which) noexcept;
  void settle(std::span<const cloud::CloudView> clouds, Buffer<splice::SplicedView>& out) noexcept;

  Config config_;
  std::optional<SurfaceStart> start_;
  std::optional<search::GridIndex> index_;
  std::optional<search::GridIndex> source_index_;
  std::span<splice::FrontView> fronts_;
  cloud::CloudBuffer target_;
  cloud::NormalsBuffer normals_;
  Buffer<splice::StartCandidate> refined_;
  Buffer<CloudSpliceRow> rows_;
  double noise_mm_ = 0.0;
  double scale_mm_ = 1.0;  ///< Noise and spacing of the clouds, the larger.
};

}  // namespace dseam::pipeline
