// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "dseam/torch/torch_planner.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/analytic_saddle.hpp"

namespace dseam::test {

inline constexpr std::size_t kMaxSeamPoints = 4000;

struct PlannedTorch {
  torch::TorchPlanner::Report report;
  std::vector<torch::TorchPoint> points;

  [[nodiscard]] std::uint32_t count(torch::Weldable weldable) const {
    return report.by_weldable[static_cast<std::size_t>(weldable)];
  }
};

inline PlannedTorch plan_torch(const torch::TorchPlanner::Config& config,
                               const seam::SeamView& seam, std::size_t room = kMaxSeamPoints) {
  ArenaOwner owner(torch::TorchPlanner::bytes(kMaxSeamPoints));
  auto planner = torch::TorchPlanner::make(config, kMaxSeamPoints, owner.arena()).value();
  std::vector<torch::TorchPoint> storage(room);
  Buffer<torch::TorchPoint> out(storage);
  const AllocationCounter counter;
  PlannedTorch planned{planner.run(seam, out), {}};
  EXPECT_EQ(counter.count(), 0U);
  planned.points.assign(out.view().begin(), out.view().end());
  return planned;
}

}  // namespace dseam::test
