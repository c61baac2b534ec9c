// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/trajectory/path_spline.hpp"
#include "dseam/trajectory/set_point.hpp"
#include "dseam/trajectory/time_scaling.hpp"
#include "dseam/trajectory/weld_table.hpp"

namespace dseam::trajectory {

/// Reads a timed path at an even rate.
///
/// Memory:  none of its own; the timed path and its path must outlive it.
/// Time:    next() is O(1) on average and O(nodes passed in one period) at worst.
/// Context: the cycle; one thread at a time.
class Sampler {
 public:
  /// Errors:  kInvalidArgument: no period, or a path without nodes.
  [[nodiscard]] static Result<Sampler> make(const TimedPathView& timed, const WeldTable& table,
                                            std::uint32_t period_us) noexcept;

  /// The next set point; false, and nothing written, after the last one. The last one is at rest
  /// at the end of the path, up to a period after its duration.
  DSEAM_NONBLOCKING bool next(SetPoint& out) noexcept;
  /// How many set points there are in all.
  [[nodiscard]] std::uint32_t size() const noexcept { return size_; }

 private:
  /// Walks forward through the nodes: s and its integral at a rising time.
  struct Cursor {
    std::size_t node = 0;
    double s_mm = 0.0;
    double integral_mm_s = 0.0;
  };
  Sampler(const TimedPathView& timed, const WeldTable& table, std::uint32_t period_us) noexcept;
  void advance(Cursor& cursor, double t_s) const noexcept;
  void find_span(double s_mm) noexcept;
  void move(double s_mm, double speed_mm_s, SetPoint& out) noexcept;
  void rest(std::size_t point, SetPoint& out) const noexcept;
  void set_process(const torch::PathPoint& point, SetPoint& out) const noexcept;

  TimedPathView timed_;
  WeldTable table_;
  std::uint32_t period_us_ = 0;
  std::uint32_t size_ = 0;
  std::uint32_t index_ = 0;
  Cursor front_;
  Cursor back_;
  PathSpan span_;
  std::size_t point_ = 0;  ///< The path point at the beginning of `span_`.
  std::size_t begin_ = 0;  ///< The stretch in which it lies.
  std::size_t end_ = 0;
};

/// All set points at once. False when the buffer is too small; it then holds what fitted.
[[nodiscard]] bool sample_all(Sampler& sampler, Buffer<SetPoint>& out) noexcept;

}  // namespace dseam::trajectory
