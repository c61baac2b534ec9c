// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "dseam/splice/live_splicer.hpp"
#include "dseam/splice/pipes/pipe_match.hpp"
#include "dseam/splice/spliced_view.hpp"

namespace dseam::splice {

/// Places a view that has no usable start by the pipes that it and a standing view show.
///
/// A place counts only if the surfaces then agree and no other place is left that might be meant:
/// a view that fits in two places is not placed.
///
/// Frame:   base.
/// Time:    at most two runs of LiveSplicer for each standing view.
class PipePlacer {
 public:
  struct Config {
    double depth_sigma_mm = 0.01;     ///< Of a depth bowl and offset that all views share.
    double max_share_before = 0.002;  ///< Of a view before what others saw; more does not hold,
    double sure_share_before = 0.05;  ///< and this much rules a place out.
    double max_pull_mm = 5.0;  ///< How far surfaces may move the shell from its pipes' place.
    double reported_sigma_mm = 1.0;
    double reported_sigma_rad = 0.0052359877559829881;
    double report_gate_mm = 100.0;  ///< A report nearer than this tells two places apart,
    double report_gate_rad = 0.35;  ///< if it is no further turned.
  };
  enum class State : std::uint8_t {
    kNotSought,
    kPlaced,
    kNoPair,       ///< The view itself shows no two pipes: see its pair.
    kNoPartner,    ///< No standing view does.
    kOtherPipes,   ///< Those of the standing views have other radii, angle or distance.
    kAmbiguous,    ///< It fits in several places.
    kContradicts,  ///< Where the pipes fit the surfaces do not.
  };
  struct Report {
    State state = State::kNotSought;
    std::uint32_t partner = 0;  ///< The standing view that it was placed by.
    geometry::Matrix6 covariance = geometry::Matrix6::Zero();  ///< About the base origin.
    double report_chi_squared = 0.0;  ///< Of the reported pose; 0 without one.
    bool report_far_off = false;
    LiveSplicer::Report live;  ///< From the pipes' place.
  };

  PipePlacer(const Config& config, const LiveSplicer::Config& live) noexcept
      : config_(config), live_(live) {}

  /// True when a view that was spliced from its report stands there against what others saw.
  [[nodiscard]] bool contradicted(const LiveSplicer::Report& live) const noexcept;
  /// Shape:   `pairs` has one entry for each of `others`, and those that are `used` are looked at.
  [[nodiscard]] Report run(const PosedView& view, const PipePair& pair,
                           const ReportedPose& reported, std::span<const PosedView> others,
                           std::span<const PipePair> pairs) const noexcept;

 private:
  struct Candidate;
  [[nodiscard]] Candidate candidate(const PosedView& view, const PosedView& partner,
                                    const PipePlace& place, const ReportedPose& reported,
                                    std::span<const PosedView> others,
                                    const Eigen::Vector3d& shell_camera) const noexcept;
  [[nodiscard]] Report by_partner(const PosedView& view, const PipePair& pair,
                                  const ReportedPose& reported, std::span<const PosedView> others,
                                  std::size_t partner, const PipePair& partners) const noexcept;
  [[nodiscard]] bool is_near(const geometry::RigidTransform& T_base_camera,
                             const ReportedPose& reported) const noexcept;

  Config config_;
  LiveSplicer live_;
};

}  // namespace dseam::splice
