// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/motion_chain.hpp"

namespace dseam::pipeline {

MotionChain::MotionChain(const Config& config, const torch::TorchPlanner& torch_planner,
                         const torch::PathPlanner& path_planner,
                         const trajectory::TimeScaling& time_scaling,
                         std::span<torch::TorchPoint> torch,
                         std::span<torch::PathPoint> path) noexcept
    : table_(config.table),
      period_us_(config.period_us),
      torch_planner_(torch_planner),
      path_planner_(path_planner),
      time_scaling_(time_scaling),
      torch_(torch),
      path_(path) {}

Result<MotionChain> MotionChain::make(const Config& config, const Capacity& capacity,
                                      Arena& arena) noexcept {
  const auto torch_planner =
      torch::TorchPlanner::make(config.torch, capacity.max_seam_points, arena);
  if (!torch_planner.ok()) {
    return torch_planner.error();
  }
  const auto path_planner = torch::PathPlanner::make(config.path);
  if (!path_planner.ok()) {
    return path_planner.error();
  }
  const auto time_scaling =
      trajectory::TimeScaling::make(config.limits, capacity.max_path_points, arena);
  if (!time_scaling.ok()) {
    return time_scaling.error();
  }
  const auto torch = arena.take<torch::TorchPoint>(capacity.max_torch_points);
  const auto path = arena.take<torch::PathPoint>(capacity.max_path_points);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return MotionChain(config, torch_planner.value(), path_planner.value(), time_scaling.value(),
                     torch, path);
}

MotionChain::Report MotionChain::plan(const seam::SeamView& seam,
                                      const torch::TorchPose* now) noexcept {
  Report report;
  torch_.clear();
  path_.clear();
  report.torch = torch_planner_.run(seam, torch_);
  if (report.torch.state != torch::TorchPlanner::State::kPlanned) {
    return report;
  }
  const torch::TorchCurveView curve{torch_.view(), report.torch.length_mm, seam.closed};
  report.path =
      now == nullptr ? path_planner_.run(curve, path_) : path_planner_.run_from(*now, curve, path_);
  if (report.path.state != torch::PathPlanner::State::kPlanned) {
    return report;
  }
  report.time = time_scaling_.run(path_.view());
  return report;
}

Result<trajectory::Sampler> MotionChain::sampler() const noexcept {
  return trajectory::Sampler::make(time_scaling_.timed_path(), table_, period_us_);
}

}  // namespace dseam::pipeline
