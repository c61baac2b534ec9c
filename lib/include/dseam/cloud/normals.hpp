// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "dseam/base/result.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/search/grid_index.hpp"

namespace dseam::cloud {

/// Fits a plane to the neighbours of each point and turns its normal towards the sensor.
///
/// The covariance is taken about the point itself, so that nothing is lost far from the origin.
///
/// Time:    O(points * neighbours); eight points share each visit.
/// Context: real-time safe; the stage has no state.
/// Source:  the paper's equations 10 to 13.
class NormalEstimation {
 public:
  struct Config {
    float radius_mm = 7.5F;
    std::uint32_t min_neighbours = 3;  ///< The point itself counts.
    float min_width_ratio = 0.01F;     ///< Narrower against their length, neighbours are collinear.
    float min_gap_ratio =
        0.01F;  ///< The two lesser eigenvalues differ by this part of the middle one.
  };
  struct Report {
    std::uint32_t good = 0;
    std::uint32_t too_few = 0;
    std::uint32_t collinear = 0;
    std::uint32_t ambiguous = 0;
    std::uint32_t not_oriented = 0;  ///< Good, but seen by no view whose sensor is known.
  };

  /// kInvalidArgument: a radius that is not positive and finite, ratios not in [0, 1].
  [[nodiscard]] static Result<NormalEstimation> make(const Config& config) noexcept;

  /// `index` was built over `cloud.points`. `sensors` has a position for each view; with one
  /// position and no `seen_by` it is the viewpoint of all; empty leaves the signs as they come. Of
  /// several views that saw a point, the one that saw it most squarely decides.
  ///
  /// Errors:  an `out` shorter than the cloud is a broken precondition. Points that the index left
  ///          out are kTooFew.
  Report run(const search::GridIndex& index, const FusedCloudView& cloud,
             std::span<const geometry::Vec3f> sensors, NormalsBuffer& out) const noexcept;

 private:
  class OfCell;
  explicit NormalEstimation(const Config& config) noexcept : config_(config) {}

  Config config_;
};

}  // namespace dseam::cloud
