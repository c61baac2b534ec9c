// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "config/settings.hpp"
#include "dseam/pipeline/motion_chain.hpp"
#include "job/broken_bead.hpp"
#include "job/lent_memory.hpp"

namespace dseam::program {

/// The motion chain over one seam, and the set points that it gives.
class MotionJob {
 public:
  /// Errors:  throws Failure(kUsage) where the configuration contradicts itself.
  MotionJob(const Settings& settings, const seam::SeamView& seam_base);

  /// Plans from the approach point; empty, and why() says why, where there is no path.
  trajectory::SetPointView plan();
  /// Plans from where the torch stands.
  trajectory::SetPointView plan_from(const torch::TorchPose& now);
  [[nodiscard]] std::string why() const;
  /// Where the arc went off when the robot ended after so many of the set points.
  [[nodiscard]] std::optional<BrokenBead> broken_after(std::size_t executed) const;
  [[nodiscard]] trajectory::SetPointView points() const { return points_; }
  [[nodiscard]] const pipeline::MotionChain::Report& report() const { return report_; }

 private:
  trajectory::SetPointView sample();

  seam::SeamView seam_base_;
  torch::PathPlanner::Config path_;
  std::unique_ptr<LentMemory> memory_;
  std::unique_ptr<pipeline::MotionChain> chain_;
  pipeline::MotionChain::Report report_;
  std::vector<trajectory::SetPoint> points_;
};

}  // namespace dseam::program
