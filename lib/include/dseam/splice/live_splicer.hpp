// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "dseam/geometry/rigid_transform.hpp"
#include "dseam/splice/observability.hpp"
#include "dseam/splice/surface_patches.hpp"

namespace dseam::splice {

/// Splices one view to those that stand already, while the robot moves on to the next.
///
/// Point to plane, patch against patch: the new view's patches are projected into the others'
/// images. Motions that this cannot see are found in the first iteration and held.
///
/// Frame:   base.
/// Time:    O(patches x views) an iteration, a bounded number of iterations.
class LiveSplicer {
 public:
  struct Config {
    double start_gate_mm = 8.0;
    double final_gate_mm = 0.3;
    double min_sensitivity = 2e-3;  ///< Of a residual to a motion, squared; less is frozen.
    double min_share_near = 0.5;    ///< Of the ties that must hold at the end.
    std::uint32_t min_ties = 40;
    std::uint32_t max_iterations = 20;
  };
  enum class State : std::uint8_t {
    kSpliced,
    kFirst,        ///< There is nothing to splice to yet.
    kNoOverlap,    ///< Too few patches meet others.
    kContradicts,  ///< They meet, but lie apart.
    kUnplaced,     ///< No first guess: neither report nor markers.
    kNotTakenIn,   ///< No room, or a frame of another size.
  };
  struct Report {
    State state = State::kUnplaced;
    geometry::RigidTransform T_base_camera;
    std::uint32_t num_ties = 0;
    double share_near = 0.0;
    /// Of the places that another view sees as well: too far before what it saw there to be true.
    double share_before = 0.0;
    double rms_mm = 0.0;
    std::uint32_t iterations = 0;
    Observability observability;
  };

  explicit LiveSplicer(const Config& config) noexcept : config_(config) {}

  /// `view` stands where it is believed to be; those of `others` that are `used` are not moved.
  [[nodiscard]] Report run(const PosedView& view, std::span<const PosedView> others) const noexcept;

 private:
  struct Sums;
  [[nodiscard]] double share_before(const PosedView& view,
                                    std::span<const PosedView> others) const noexcept;
  void tie(const PosedView& view, std::span<const PosedView> others, const Eigen::Vector3d& pivot,
           double gate_mm, Sums& sums) const noexcept;

  Config config_;
};

}  // namespace dseam::splice
