// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "dseam/base/buffer.hpp"
#include "dseam/geometry/rigid_transform.hpp"
#include "dseam/search/grid_index.hpp"

namespace dseam::splice {

/// A line that two clouds may share: a pipe's axis, or the edge in which two planes meet.
///
/// Shape:   z of each frame runs along the line; x points into the first plane's normal, or
///          anywhere about a pipe.
struct LinePair {
  geometry::RigidTransform T_a_line;
  geometry::RigidTransform T_b_line;
  bool any_spin = true;  ///< False: x is known but for its sign.
};

/// A place in which the source would lie well on the target.
struct StartCandidate {
  geometry::RigidTransform T_a_b;
  double agreement = 0.0;  ///< Mean over the source's points: 1 on the target, 0 beyond tolerance.
};

/// Where one cloud may lie to another when nothing is known but a line that both have: the turn
/// about the line, the shift along it and its two senses are tried one by one.
///
/// Time:    O(turns x shifts x samples) for each pair of lines.
class LineSearch {
 public:
  struct Config {
    double tolerance_mm = 8.0;
    double spin_step_rad = 0.08726646259971647;  ///< 5 degrees.
    double slide_step_mm = 5.0;
    double min_overlap = 0.3;  ///< Of the shorter one, along the line.
    std::uint32_t max_slides = 200;
  };

  explicit LineSearch(const Config& config) noexcept : config_(config) {}

  /// Adds the best places to `best`, best first, each apart from all others. `index` stands over
  /// the target; `target` and `source` are samples that show the clouds' extents.
  void run(std::span<const Eigen::Vector3d> target, const search::GridIndex& index,
           std::span<const Eigen::Vector3d> source, const LinePair& lines,
           Buffer<StartCandidate>& best) const noexcept;

  /// How well the source lies on the target; gives up, with 0, once `at_least` is out of reach.
  [[nodiscard]] double agreement(const search::GridIndex& index,
                                 std::span<const Eigen::Vector3d> source,
                                 const geometry::RigidTransform& T_a_b, double tolerance_mm,
                                 double at_least) const noexcept;

 private:
  void slide(std::span<const Eigen::Vector3d> source, const search::GridIndex& index,
             const LinePair& lines, const geometry::RigidTransform& turn, double from_mm,
             double to_mm, Buffer<StartCandidate>& best) const noexcept;

  Config config_;
};

/// The largest distance between the places that two transforms give the points.
[[nodiscard]] double largest_distance_mm(std::span<const Eigen::Vector3d> points,
                                         const geometry::RigidTransform& a,
                                         const geometry::RigidTransform& b) noexcept;

/// Enters a candidate into a list that is sorted by agreement; of those closer than `apart_mm` to
/// each other only the best stays.
void enter_candidate(std::span<const Eigen::Vector3d> points, const StartCandidate& candidate,
                     double apart_mm, Buffer<StartCandidate>& best) noexcept;

}  // namespace dseam::splice
