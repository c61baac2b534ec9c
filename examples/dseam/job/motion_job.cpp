// SPDX-License-Identifier: Apache-2.0
#include "job/motion_job.hpp"

#include <algorithm>

#include "failure.hpp"

namespace dseam::program {

MotionJob::MotionJob(const Settings& settings, const seam::SeamView& seam_base)
    : seam_base_(seam_base), path_(settings.motion.path) {
  pipeline::MotionChain::Capacity capacity;
  capacity.max_seam_points = settings.max_seam_points;
  memory_ = std::make_unique<LentMemory>(pipeline::MotionChain::bytes(capacity));
  auto chain = pipeline::MotionChain::make(settings.motion, capacity, memory_->arena());
  if (!chain.ok()) {
    throw Failure(ExitCode::kUsage, std::string("the configured path: ") + name(chain.error()));
  }
  chain_ = std::make_unique<pipeline::MotionChain>(std::move(chain.value()));
}

trajectory::SetPointView MotionJob::plan() {
  report_ = chain_->run(seam_base_);
  return sample();
}

trajectory::SetPointView MotionJob::plan_from(const torch::TorchPose& now) {
  report_ = chain_->run_from(now, seam_base_);
  return sample();
}

trajectory::SetPointView MotionJob::sample() {
  points_.clear();
  auto sampler = chain_->sampler();
  if (report_.planned() && sampler.ok()) {
    points_.resize(sampler.value().size());
    Buffer<trajectory::SetPoint> out(points_);
    (void)sample_all(sampler.value(), out);
  }
  return points_;
}

std::optional<BrokenBead> MotionJob::broken_after(std::size_t executed) const {
  const torch::TorchCurveView curve{chain_->torch_points(), report_.torch.length_mm,
                                    seam_base_.closed};
  return broken_bead(points().first(std::min(executed, points_.size())), curve, path_);
}

std::string MotionJob::why() const {
  using Torch = torch::TorchPlanner::State;
  using Path = torch::PathPlanner::State;
  if (report_.torch.state != Torch::kPlanned) {
    return "the torch cannot follow this seam";
  }
  if (report_.path.state == Path::kNothingWeldable) {
    return "no stretch of the seam may be welded (gap, clearance, dihedral, tilt or confidence)";
  }
  if (report_.path.state == Path::kStartTooFar) {
    return "the torch stands too far from the seam (path.max_start_mm)";
  }
  if (report_.path.state == Path::kNothingLeft) {
    return "nothing is left to weld past resume.stopped_mm";
  }
  return report_.planned() ? "" : "no path within the robot's limits";
}

}  // namespace dseam::program
