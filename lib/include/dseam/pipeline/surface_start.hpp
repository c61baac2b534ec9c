// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/seam/surface/cell_map.hpp"
#include "dseam/seam/surface/surface_finder.hpp"
#include "dseam/search/grid_index.hpp"
#include "dseam/splice/line_search.hpp"

namespace dseam::pipeline {

/// Where a cloud may lie to another when nothing at all is known beforehand: the surfaces found in
/// both (pipes, pairs of planes) share lines, and about these every turn and shift is tried.
///
/// Memory:  `bytes()` from the arena.
/// Time:    O(points) for the surfaces, then O(pairs of lines x turns x shifts x samples).
class SurfaceStart {
 public:
  static constexpr std::size_t kMaxCandidates = 12;
  static constexpr std::size_t kMaxLines = 6;  ///< Of one cloud, best supported first.
  static constexpr std::size_t kMaxSamples = 160;

  [[nodiscard]] static std::size_t bytes(std::size_t max_points) noexcept;
  /// Errors:  kInvalidArgument, kOutOfMemory.
  [[nodiscard]] static Result<SurfaceStart> make(const splice::LineSearch::Config& config,
                                                 std::size_t max_points, Arena& arena) noexcept;

  /// The cloud to lie on. `index` stands over it.
  void set_target(const cloud::CloudView& target, const search::GridIndex& index) noexcept;
  /// The places for `source`, best first; empty when the clouds share no line. Valid until the next
  /// call.
  std::span<const splice::StartCandidate> run(const cloud::CloudView& source) noexcept;

  /// Noise or spacing of a cloud, the larger.
  [[nodiscard]] double scale_mm(const cloud::CloudView& cloud) noexcept;
  /// Points spread over the last source.
  [[nodiscard]] std::span<const Eigen::Vector3d> samples() const noexcept {
    return source_.samples.view();
  }
  /// Of the last source's points about their surface.
  [[nodiscard]] double noise_mm() const noexcept { return source_.noise_mm; }
  [[nodiscard]] double spacing_mm() const noexcept { return source_.spacing_mm; }
  [[nodiscard]] const splice::LineSearch& search() const noexcept { return search_; }

 private:
  /// A pipe's axis, or the edge of two planes.
  struct Line {
    geometry::RigidTransform T_cloud_line;
    double radius_mm = 0.0;  ///< 0: the edge of two planes,
    double cosine = 0.0;     ///< whose normals have this between them.
    double support = 0.0;
  };
  struct Described {
    Buffer<Line> lines;
    Buffer<Eigen::Vector3d> samples;
    double noise_mm = 0.0;
    double spacing_mm = 0.0;
  };

  explicit SurfaceStart(const splice::LineSearch::Config& config) noexcept : search_(config) {}
  void describe(const cloud::CloudView& cloud, Described& out) noexcept;
  void enter_pipe(const seam::FoundSurface& found, Described& out) const noexcept;
  void enter_edge(const seam::FoundSurface& a, const seam::FoundSurface& b,
                  Described& out) const noexcept;
  static void enter(const Line& line, Described& out) noexcept;

  splice::LineSearch search_;
  seam::CellMap cells_;
  seam::SurfaceFinder surfaces_;
  const search::GridIndex* index_ = nullptr;
  Described target_;
  Described source_;
  Buffer<splice::StartCandidate> candidates_;
};

}  // namespace dseam::pipeline
