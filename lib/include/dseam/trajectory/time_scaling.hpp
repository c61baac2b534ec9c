// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/result.hpp"
#include "dseam/torch/torch_path.hpp"
#include "dseam/trajectory/limits.hpp"
#include "dseam/trajectory/path_spline.hpp"

namespace dseam::trajectory {

/// A moment at which the unsmoothed path length has a known value; constant acceleration between.
struct TimeNode {
  double t_s = 0.0;
  double s_mm = 0.0;
  double v_mm_s = 0.0;
  double integral_mm_s = 0.0;  ///< Of `s_mm` over time, from the start.
  std::uint32_t point = 0;     ///< The path point at or before it.
  LimitKind limited_by = LimitKind::kNone;
  bool rests = false;              ///< Stands still to the next node.
  std::uint32_t last_limited = 0;  ///< The last node up to this one that is limited.
};

/// A path with its time law: s(t) is the mean of the nodes' s over the last `window_s` seconds.
///
/// The mean of a velocity that keeps |a| <= A over a window of A / J keeps |a| <= A, and |jerk| <=
/// J where at least a window lies between speeding up and slowing down, so that ramps are
/// jerk-limited by construction.
struct TimedPathView {
  torch::PathView path;
  std::span<const TimeNode> nodes;
  double window_s = 0.0;
  double duration_s = 0.0;
};

/// Gives a path its time: the speed asked for wherever the limits allow it, jerk-limited ramps
/// where they do not, at rest and without acceleration at both ends and at every stop.
///
/// Memory:  bytes(max_points) of the arena.
/// Time:    O(points); about a microsecond each on a desktop processor.
/// Context: one thread at a time; no heap, lock or system call.
class TimeScaling {
 public:
  enum class State : std::uint8_t {
    kTimed,
    kTooFewPoints,    ///< Fewer than two.
    kNoLength,        ///< Every point lies on the first one, and none stands for a time.
    kBadPoint,        ///< Not finite, no unit quaternion, speed not positive, length falls.
    kTurnsOnTheSpot,  ///< Two points at one place differ in orientation.
    kTooLong,         ///< Longer than the nodes' storage, or than 2^32 microseconds.
  };
  struct Report {
    State state = State::kTooFewPoints;
    double duration_s = 0.0;
    double length_mm = 0.0;
    std::uint32_t stops = 0;
    std::array<double, kNumLimitKinds> slowed_mm{};  ///< Length held back, by what.
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_points) noexcept {
    return Arena::bytes<TimeNode>(nodes_for(max_points)) +
           Arena::bytes<Cell>(nodes_for(max_points));
  }
  /// Errors:  kInvalidArgument: a limit that is not finite and positive. kOutOfMemory.
  [[nodiscard]] static Result<TimeScaling> make(const Limits& limits, std::size_t max_points,
                                                Arena& arena) noexcept;

  /// `path` must outlive the use of timed_path().
  Report run(torch::PathView path) noexcept;
  /// What run() made; empty unless it said kTimed.
  [[nodiscard]] TimedPathView timed_path() const noexcept;

 private:
  /// The piece of path between two neighbouring nodes while its speed is being found.
  struct Cell {
    double length_mm = 0.0;
    double max_v_mm_s = 0.0;  ///< Greatest speed on it,
    double v_mm_s = 0.0;      ///< and the one at its beginning.
    PathRates rates;          ///< At most these.
    std::uint32_t point = 0;
    LimitKind limited_by = LimitKind::kNone;
  };
  static constexpr std::size_t kMinCells = 16;  ///< In each stretch between two stops.
  static constexpr std::size_t nodes_for(std::size_t max_points) noexcept {
    return kMinCells * 16 + 3 * max_points;
  }

  TimeScaling(const Limits& limits, std::span<TimeNode> nodes, std::span<Cell> cells) noexcept
      : limits_(limits), nodes_(nodes), cells_(cells) {}
  State check(torch::PathView path) const noexcept;
  bool cut_path(torch::PathView path) noexcept;
  bool cut_stretch(torch::PathView path, std::size_t begin, std::size_t end) noexcept;
  void bound_speed(double asked_mm_s, Cell& cell) const noexcept;
  void choose_acceleration() noexcept;
  [[nodiscard]] double jerk_beside(double acceleration_mm_s2) const noexcept;
  [[nodiscard]] double acceleration_on(std::span<const Cell> cells) const noexcept;
  void erode(std::span<Cell> cells, double acceleration_mm_s2) const noexcept;
  static void ramp(std::span<Cell> cells, double acceleration_mm_s2) noexcept;
  void hold_peaks(std::span<Cell> cells) const noexcept;
  void hold_peak(std::span<Cell> cells, double end_mm_s, double top_mm_s) const noexcept;
  bool append_stretch(std::span<Cell> cells, double s_mm, Report& report) noexcept;
  bool append_rest(std::size_t point, double s_mm, double rest_s) noexcept;
  bool append_node(TimeNode node) noexcept;

  Limits limits_;
  std::span<TimeNode> nodes_;
  std::span<Cell> cells_;
  torch::PathView path_;
  std::size_t num_nodes_ = 0;
  std::size_t num_cells_ = 0;
  double max_acceleration_mm_s2_ = 0.0;  ///< Of s.
  double window_s_ = 0.0;
  double duration_s_ = 0.0;
};

}  // namespace dseam::trajectory
