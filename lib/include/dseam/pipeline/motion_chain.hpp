// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/seam/seam_curve.hpp"
#include "dseam/torch/path_planner.hpp"
#include "dseam/torch/torch_planner.hpp"
#include "dseam/trajectory/sampler.hpp"
#include "dseam/trajectory/time_scaling.hpp"

namespace dseam::pipeline {

/// From a seam to the timed path of the torch: torch poses, then path, then time.
///
/// Frame:   base.
/// Memory:  `bytes()` from the arena at make(); run() takes none.
/// Time:    linear in the points of seam and path.
/// Context: one thread; not the cycle path. Only the sampler that it hands out is.
class MotionChain {
 public:
  struct Config {
    torch::TorchPlanner::Config torch;
    torch::PathPlanner::Config path;
    trajectory::Limits limits;
    trajectory::WeldTable table;
    std::uint32_t period_us = 10000;  ///< Between two set points.
  };
  struct Capacity {
    std::size_t max_seam_points = 4096;
    std::size_t max_torch_points = 8192;
    std::size_t max_path_points = 32768;
  };
  /// A stage that was not reached keeps its first state, which says so.
  struct Report {
    torch::TorchPlanner::Report torch;
    torch::PathPlanner::Report path;
    trajectory::TimeScaling::Report time;

    [[nodiscard]] bool planned() const noexcept {
      return time.state == trajectory::TimeScaling::State::kTimed;
    }
  };

  [[nodiscard]] static constexpr std::size_t bytes(const Capacity& capacity) noexcept {
    return torch::TorchPlanner::bytes(capacity.max_seam_points) +
           trajectory::TimeScaling::bytes(capacity.max_path_points) +
           Arena::bytes<torch::TorchPoint>(capacity.max_torch_points) +
           Arena::bytes<torch::PathPoint>(capacity.max_path_points);
  }
  /// Errors:  kInvalidArgument: a value of a stage out of range. kOutOfMemory: the arena.
  [[nodiscard]] static Result<MotionChain> make(const Config& config, const Capacity& capacity,
                                                Arena& arena) noexcept;

  /// Plans from the approach point of the first bead.
  Report run(const seam::SeamView& seam) noexcept { return plan(seam, nullptr); }
  /// Plans from where the torch is now.
  Report run_from(const torch::TorchPose& now, const seam::SeamView& seam) noexcept {
    return plan(seam, &now);
  }

  /// What the last run made; empty where it failed.
  [[nodiscard]] torch::PathView path() const noexcept { return path_.view(); }
  [[nodiscard]] std::span<const torch::TorchPoint> torch_points() const noexcept {
    return torch_.view();
  }
  /// Reads the timed path; this object must outlive it.
  ///
  /// Errors:  kInvalidArgument: nothing is planned.
  [[nodiscard]] Result<trajectory::Sampler> sampler() const noexcept;

 private:
  MotionChain(const Config& config, const torch::TorchPlanner& torch_planner,
              const torch::PathPlanner& path_planner, const trajectory::TimeScaling& time_scaling,
              std::span<torch::TorchPoint> torch, std::span<torch::PathPoint> path) noexcept;
  Report plan(const seam::SeamView& seam, const torch::TorchPose* now) noexcept;

  trajectory::WeldTable table_;
  std::uint32_t period_us_;
  torch::TorchPlanner torch_planner_;
  torch::PathPlanner path_planner_;
  trajectory::TimeScaling time_scaling_;
  Buffer<torch::TorchPoint> torch_;
  Buffer<torch::PathPoint> path_;
};

}  // namespace dseam::pipeline
