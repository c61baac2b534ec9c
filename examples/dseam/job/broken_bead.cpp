// SPDX-License-Identifier: Apache-2.0
#include "job/broken_bead.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace dseam::program {
namespace {

using trajectory::SetPoint;
using trajectory::SetPointView;

constexpr double kAtTheStartMm = 5.0;

/// Arc length on the torch curve nearest to a place.
double foot_mm(const Eigen::Vector3d& p_base, const torch::TorchCurveView& curve) {
  const auto nearest = std::min_element(
      curve.points.begin(), curve.points.end(),
      [&p_base](const torch::TorchPoint& a, const torch::TorchPoint& b) {
        return (a.pose.p_base - p_base).squaredNorm() < (b.pose.p_base - p_base).squaredNorm();
      });
  return nearest->s_mm + (p_base - nearest->pose.p_base).dot(nearest->tangent);
}

/// `travel_mm` less or more whole turns, so that it lies in the segment of the set point.
double in_segment_mm(double travel_mm, const SetPoint& last, double begun_mm, double turn_mm) {
  if (last.segment == torch::Segment::kOverlap) {  // It begins after one turn.
    return turn_mm + std::max(0.0, travel_mm - turn_mm * std::round(travel_mm / turn_mm));
  }
  const double once_mm = travel_mm - turn_mm * std::floor(travel_mm / turn_mm);
  const bool before_start = begun_mm < kAtTheStartMm && once_mm > turn_mm - kAtTheStartMm;
  return before_start ? 0.0 : once_mm;
}

}  // namespace

std::string BrokenBead::resume_options() const {
  char text[128];
  std::snprintf(text, sizeof(text),
                "--set resume.active=true --set resume.pass=%u --set resume.stopped_mm=%.1f", pass,
                stopped_mm);
  return text;
}

std::optional<BrokenBead> broken_bead(SetPointView executed, const torch::TorchCurveView& curve,
                                      const torch::PathPlanner::Config& path) {
  const auto burns = [](const SetPoint& point) {
    return point.arc && point.segment != torch::Segment::kCrater;
  };
  const auto last = std::find_if(executed.rbegin(), executed.rend(), burns);
  if (last == executed.rend() || curve.points.empty()) {
    return std::nullopt;
  }
  const auto first = std::find_if(executed.begin(), executed.end(), [&](const SetPoint& point) {
    return burns(point) && point.pass == last->pass;
  });
  const double start_mm = path.start_mm + path.passes[last->pass].start_shift_mm;
  const double travel_mm = foot_mm(last->pose.p_base, curve) - start_mm;
  if (!curve.closed) {
    return BrokenBead{last->pass, std::max(0.0, travel_mm)};
  }
  return BrokenBead{last->pass,
                    in_segment_mm(travel_mm, *last, last->s_mm - first->s_mm, curve.length_mm)};
}

}  // namespace dseam::program
