// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/result.hpp"
#include "dseam/geometry/rigid_transform.hpp"
#include "dseam/hal/robot_state.hpp"

namespace dseam::hal {

/// The last reported poses, interpolated: what every source of a RobotState keeps them in.
///
/// Translation goes on a straight line, rotation about one axis at constant speed.
///
/// Memory:  lent slots; the oldest report is overwritten.
/// Time:    pose_at(): O(slots).
/// Context: push() from one thread, pose_at() from any; neither waits.
class InterpolatedPoses final : public RobotState {
 public:
  struct Config {
    std::int64_t max_gap_ns = 100'000'000;  ///< Reports farther apart are not bridged.
  };

  /// One report and the number of its writing, which is odd while it is being written.
  class Slot {
   public:
    void store(const StampedPose& pose) noexcept;
    /// False when nothing was stored yet, or the writer came in between.
    [[nodiscard]] bool load(StampedPose& pose) const noexcept;

   private:
    std::atomic<std::uint64_t> writing_{0};
    std::atomic<std::int64_t> stamp_ns_{0};
    std::atomic<PoseOf> of_{PoseOf::kFlange};
    std::array<std::atomic<double>, 12> numbers_{};
  };

  InterpolatedPoses(std::span<Slot> slots, const Config& config) noexcept
      : slots_(slots), config_(config) {}
  explicit InterpolatedPoses(std::span<Slot> slots) noexcept : InterpolatedPoses(slots, Config{}) {}

  /// Adds a report.
  ///
  /// Errors:  kInvalidArgument: not later than the one before, or not finite.
  Result<> push(const StampedPose& pose) noexcept;

 private:
  Result<StampedPose> do_pose_at(std::int64_t stamp_ns) noexcept override;

  std::span<Slot> slots_;
  Config config_;
  std::size_t next_ = 0;
  bool any_ = false;
  std::int64_t newest_ns_ = 0;
};

inline void InterpolatedPoses::Slot::store(const StampedPose& pose) noexcept {
  const std::uint64_t writing = writing_.load(std::memory_order_relaxed);
  writing_.store(writing + 1, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
  stamp_ns_.store(pose.stamp_ns, std::memory_order_relaxed);
  of_.store(pose.of, std::memory_order_relaxed);
  for (std::size_t i = 0; i < 9; ++i) {
    numbers_[i].store(pose.T_base_reported.rotation.data()[i], std::memory_order_relaxed);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    numbers_[9 + i].store(pose.T_base_reported.translation_mm.data()[i], std::memory_order_relaxed);
  }
  writing_.store(writing + 2, std::memory_order_release);
}

inline bool InterpolatedPoses::Slot::load(StampedPose& pose) const noexcept {
  const std::uint64_t before = writing_.load(std::memory_order_acquire);
  pose.stamp_ns = stamp_ns_.load(std::memory_order_relaxed);
  pose.of = of_.load(std::memory_order_relaxed);
  for (std::size_t i = 0; i < 9; ++i) {
    pose.T_base_reported.rotation.data()[i] = numbers_[i].load(std::memory_order_relaxed);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    pose.T_base_reported.translation_mm.data()[i] = numbers_[9 + i].load(std::memory_order_relaxed);
  }
  std::atomic_thread_fence(std::memory_order_acquire);
  return before != 0 && before % 2 == 0 && writing_.load(std::memory_order_relaxed) == before;
}

inline Result<> InterpolatedPoses::push(const StampedPose& pose) noexcept {
  const bool later = !any_ || pose.stamp_ns > newest_ns_;
  const bool finite =
      pose.T_base_reported.rotation.allFinite() && pose.T_base_reported.translation_mm.allFinite();
  if (slots_.empty() || !later || !finite) {
    return Errc::kInvalidArgument;
  }
  slots_[next_].store(pose);
  next_ = (next_ + 1) % slots_.size();
  newest_ns_ = pose.stamp_ns;
  any_ = true;
  return {};
}

inline Result<StampedPose> InterpolatedPoses::do_pose_at(std::int64_t stamp_ns) noexcept {
  StampedPose before;
  StampedPose after;
  bool has_before = false;
  bool has_after = false;
  for (const Slot& slot : slots_) {
    StampedPose pose;
    if (!slot.load(pose)) {
      continue;
    }
    if (pose.stamp_ns <= stamp_ns && (!has_before || pose.stamp_ns > before.stamp_ns)) {
      before = pose;
      has_before = true;
    }
    if (pose.stamp_ns >= stamp_ns && (!has_after || pose.stamp_ns < after.stamp_ns)) {
      after = pose;
      has_after = true;
    }
  }
  if (!has_before || !has_after || before.of != after.of ||
      after.stamp_ns - before.stamp_ns > config_.max_gap_ns) {
    return Errc::kNotFound;
  }
  if (after.stamp_ns == before.stamp_ns) {
    return before;
  }
  const double share = static_cast<double>(stamp_ns - before.stamp_ns) /
                       static_cast<double>(after.stamp_ns - before.stamp_ns);
  const geometry::RigidTransform& from = before.T_base_reported;
  const geometry::RigidTransform& to = after.T_base_reported;
  const Eigen::Matrix3d turn = from.rotation.transpose() * to.rotation;
  const Eigen::Vector3d travel_mm = to.translation_mm - from.translation_mm;
  return StampedPose{stamp_ns,
                     before.of,
                     {from.rotation * geometry::rotation_exp(share * geometry::rotation_log(turn)),
                      from.translation_mm + share * travel_mm}};
}

}  // namespace dseam::hal
