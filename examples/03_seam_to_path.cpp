// SPDX-License-Identifier: Apache-2.0
// From a seam to the set points of the robot: here a circle on a plate, known beforehand.
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <vector>

#include "dseam/pipeline/motion_chain.hpp"

namespace {

constexpr double kRadiusMm = 50.0;

/// A pipe that stands on a plate: n_shell up, n_nozzle outwards, travel counter-clockwise.
std::vector<dseam::seam::SeamPoint> circle() {
  std::vector<dseam::seam::SeamPoint> points(600);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(i) / 600.0;
    dseam::seam::SeamPoint& point = points[i];
    point.s_mm = kRadiusMm * turn;
    point.n_nozzle = {std::cos(turn), std::sin(turn), 0.0};
    point.p_base = kRadiusMm * point.n_nozzle;
    point.tangent = {-std::sin(turn), std::cos(turn), 0.0};
    point.dihedral_rad = std::numbers::pi / 2.0;
    point.confidence = dseam::seam::Confidence::kHigh;
    point.source = dseam::seam::Source::kMeasured;
  }
  return points;
}

}  // namespace

int main() {
  using dseam::pipeline::MotionChain;
  const auto points = circle();
  const MotionChain::Capacity capacity;
  const std::size_t size_bytes = MotionChain::bytes(capacity);
  const auto memory = std::make_unique_for_overwrite<std::byte[]>(size_bytes);
  dseam::Arena arena(std::span(memory.get(), size_bytes));
  auto chain = MotionChain::make({}, capacity, arena);
  if (!chain.ok()) {
    return 1;
  }

  const auto report = chain.value().run({points, 2.0 * std::numbers::pi * kRadiusMm});
  auto sampler = chain.value().sampler();
  if (!report.planned() || !sampler.ok()) {
    std::printf("no path within the limits\n");
    return 1;
  }
  dseam::trajectory::SetPoint point;
  std::size_t welding = 0;
  std::size_t count = 0;
  for (; sampler.value().next(point); ++count) {
    welding += point.arc ? 1U : 0U;
  }
  std::printf("%zu set points, %zu of them with the arc on, %.1f s\n", count, welding,
              1e-6 * point.t_us);
  return welding > 0 ? 0 : 1;
}
