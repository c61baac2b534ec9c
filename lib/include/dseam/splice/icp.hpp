// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "dseam/base/arena.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/geometry/rigid_transform.hpp"
#include "dseam/search/grid_index.hpp"
#include "dseam/splice/observability.hpp"

namespace dseam::splice {

enum class IcpMetric : std::uint8_t {
  kPointToPoint,  ///< The paper's equation 1.
  kPointToPlane,
};

enum class IcpStop : std::uint8_t {
  kBelowThreshold,  ///< E fell under the paper's 1e-3 mm^2.
  kNoLongerFalls,   ///< What happens at real point spacings.
  kMaxIterations,
  kNoOverlap,  ///< Too few points have a counterpart; the start is returned.
};

/// Registers one cloud to another whose index stands.
///
/// Pairs are trimmed by Tukey's weight under a gate that shrinks with the residuals. Motions that
/// the pairs cannot see are found in the first iteration, reported, and held: a pipe does not drift
/// along its axis.
///
/// Source:  equation 1 of the paper; Besl and McKay 1992, Chen and Medioni 1992.
class Icp {
 public:
  struct Config {
    IcpMetric metric = IcpMetric::kPointToPlane;
    double start_gate_mm = 10.0;
    double final_gate_mm = 0.5;     ///< The gate shrinks to five sigma, never under this.
    double stop_error_mm2 = 1e-3;   ///< Point to point only.
    double stop_fall = 1e-4;        ///< Of E, relative: falling less is not falling.
    double min_sensitivity = 2e-3;  ///< Of a residual to a motion, squared; less is frozen.
    double min_overlap = 0.1;       ///< Share of the source that must have a counterpart.
    std::uint32_t max_iterations = 40;
    std::uint32_t stride = 1;  ///< Every how manieth source point is looked at.
  };
  struct Report {
    IcpStop stop = IcpStop::kNoOverlap;
    geometry::RigidTransform T_target_source;
    geometry::Matrix6 covariance = geometry::Matrix6::Zero();  ///< About the target's origin.
    double error_mm2 = 0.0;  ///< E: the mean square of the paired distances.
    double rms_mm = 0.0;     ///< Of the residuals that the metric counts.
    double overlap = 0.0;
    std::uint32_t iterations = 0;
    Observability observability;
  };

  explicit Icp(const Config& config) noexcept : config_(config) {}

  /// Shape:   `normals` are the target's, one a point; empty for point to point. A zero normal's
  ///          point is no counterpart.
  /// Time:    O(source points) queries an iteration, at most `max_iterations`.
  [[nodiscard]] Report run(const cloud::CloudView& source, const cloud::CloudView& target,
                           const cloud::NormalsView& normals, const search::GridIndex& index,
                           const geometry::RigidTransform& start_T_target_source) const noexcept;

 private:
  struct Sums;
  [[nodiscard]] Sums pair_up(const cloud::CloudView& source, const cloud::CloudView& target,
                             const cloud::NormalsView& normals, const search::GridIndex& index,
                             const geometry::RigidTransform& T, const Eigen::Vector3d& pivot,
                             double gate_mm) const noexcept;

  Config config_;
};

}  // namespace dseam::splice
