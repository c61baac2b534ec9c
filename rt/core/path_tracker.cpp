// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/path_tracker.hpp"

#include <algorithm>

namespace dseam::rt {
namespace {

double distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                           const Eigen::Vector3d& b) noexcept {
  const Eigen::Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  const double u = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - a - u * along).norm();
}

}  // namespace

void PathTracker::begin(trajectory::SetPointView points, std::int64_t now_ns) noexcept {
  points_ = points;
  begun_ns_ = now_ns;
  progress_ns_ = now_ns;
  pose_ns_ = now_ns;
  stood_since_ns_ = now_ns;
}

/// The pose speaks of its own moment: the point it names by 16 bits, near the newest one.
std::size_t PathTracker::index_of(const link::PoseReport& pose,
                                  std::uint32_t executed) const noexcept {
  const auto behind = static_cast<std::uint16_t>(executed - pose.exec_seq);
  const std::uint32_t done = behind <= executed ? executed - behind : executed;
  const std::size_t last = points_.size() - 1;
  return std::min<std::size_t>(done > 0 ? done - 1 : 0, last);
}

void PathTracker::look(const link::PoseReport& pose, std::uint32_t executed, std::int64_t now_ns,
                       ArcInputs& in) noexcept {
  if (executed != executed_) {
    executed_ = executed;
    progress_ns_ = now_ns;
  }
  if (pose.robot_time_us != pose_us_) {
    pose_us_ = pose.robot_time_us;
    pose_ns_ = now_ns;
  }
  in.stream_age_ns = now_ns - progress_ns_;
  in.pose_age_ns = now_ns - pose_ns_;
  in.p_base = pose.pose.p_base;
  in.speed_mm_s = pose.speed_mm_s;
  const bool moved = (in.p_base - stood_at_).norm() > config_.standing_mm;
  if (moved || !pose.arc_on) {
    stood_at_ = in.p_base;
    stood_since_ns_ = now_ns;
  }
  in.standing_ns = now_ns - stood_since_ns_;
  if (!points_.empty()) {
    look_at_place(index_of(pose, executed), in);
    in.planned_low_mm_s = now_ns - begun_ns_ < config_.settle_ns ? 0.0 : in.planned_low_mm_s;
  }
}

void PathTracker::look_at_place(std::size_t index, ArcInputs& in) const noexcept {
  const std::size_t first = index > kAround ? index - kAround : 0;
  const std::size_t last = std::min(index + kAround, points_.size() - 1);
  in.tracking_mm = (in.p_base - points_[index].pose.p_base).norm();
  in.corridor_mm = in.tracking_mm;
  in.confidence = std::min(in.confidence, points_[index].confidence);
  in.planned_low_mm_s = points_[index].speed_mm_s;
  in.planned_high_mm_s = points_[index].speed_mm_s;
  for (std::size_t i = first; i < last; ++i) {
    in.corridor_mm = std::min(in.corridor_mm, distance_to_segment(in.p_base, points_[i].pose.p_base,
                                                                  points_[i + 1].pose.p_base));
    in.planned_low_mm_s = std::min(in.planned_low_mm_s, points_[i].speed_mm_s);
    in.planned_high_mm_s = std::max(in.planned_high_mm_s, points_[i].speed_mm_s);
  }
}

}  // namespace dseam::rt
