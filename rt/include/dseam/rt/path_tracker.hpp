// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/link/messages.hpp"
#include "dseam/rt/arc_gate.hpp"
#include "dseam/trajectory/set_point.hpp"

namespace dseam::rt {

/// Compares where the torch is with where it was sent.
///
/// Time:    O(1): a fixed number of set points around the one in hand.
/// Context: the cycle.
class PathTracker {
 public:
  struct Config {
    double standing_mm = 0.5;              ///< Moving less than this is standing.
    std::int64_t settle_ns = 500'000'000;  ///< After a start the torch may still be slower.
  };
  explicit PathTracker(const Config& config) noexcept : config_(config) {}

  /// A trajectory begins, or goes on after a hold.
  void begin(trajectory::SetPointView points, std::int64_t now_ns) noexcept;
  /// Fills in what the arc gate needs to know of place and speed. `executed`: points done, by the
  /// newest status.
  DSEAM_NONBLOCKING void look(const link::PoseReport& pose, std::uint32_t executed,
                              std::int64_t now_ns, ArcInputs& in) noexcept;

 private:
  static constexpr std::size_t kAround = 8;

  [[nodiscard]] std::size_t index_of(const link::PoseReport& pose,
                                     std::uint32_t executed) const noexcept;
  void look_at_place(std::size_t index, ArcInputs& in) const noexcept;

  Config config_;
  trajectory::SetPointView points_;
  std::int64_t begun_ns_ = 0;
  std::uint32_t executed_ = 0;
  std::int64_t progress_ns_ = 0;
  std::uint64_t pose_us_ = 0;
  std::int64_t pose_ns_ = 0;
  Eigen::Vector3d stood_at_ = Eigen::Vector3d::Zero();
  std::int64_t stood_since_ns_ = 0;
};

}  // namespace dseam::rt
