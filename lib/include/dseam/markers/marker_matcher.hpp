// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/result.hpp"
#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::markers {

/// Which marker of one set is which of another.
struct MarkerPair {
  std::uint16_t a = 0;
  std::uint16_t b = 0;
};

enum class MatchState : std::uint8_t {
  kMatched,
  kTooFew,     ///< Fewer than three markers agree.
  kCollinear,  ///< Those that agree lie on a line.
  kClustered,  ///< They lie so close together that the far side would be guessed.
  kSymmetric,  ///< Another assignment fits as well, or there are too many to rule that out.
  kMirrored,   ///< They agree only after a reflection.
};

struct MatchReport {
  MatchState state = MatchState::kTooFew;
  geometry::RigidTransform T_a_b;
  std::uint32_t num_pairs = 0;      ///< Of the best assignment, also when it is refused.
  std::uint32_t num_runner_up = 0;  ///< Of the best one that contradicts it.
  bool cut_short = false;           ///< Not all assignments were tried.
  double rms_mm = 0.0;
  double spread_mm = 0.0;          ///< Second largest standard deviation of their places.
  double error_at_reach_mm = 0.0;  ///< Predicted, at `Config::reach_mm` from their centre.
};

/// The markers that two views share, by mutual distances: no first guess is needed.
///
/// Every pair of distances that agree, with a third marker on either side of it, makes a
/// hypothesis; the one under which most markers agree wins, if no other comes near.
///
/// Memory:  O(max_markers), from the arena.
/// Time:    bounded: at most kMaxHypotheses are tried and kMaxCompared distances compared, three
///          times over. A search that was cut short does not match.
class MarkerMatcher {
 public:
  struct Config {
    double tolerance_mm = 0.25;  ///< Between two views of one marker.
    double sigma_mm = 0.03;      ///< Of one marker's place in one view, for the predicted error.
    std::uint32_t min_pairs = 3;
    std::uint32_t min_lead = 2;  ///< More pairs than the best contradicting assignment has.
    double min_spread_mm = 8.0;
    double reach_mm = 150.0;      ///< How far from the markers the pose must hold.
    double max_error_mm = 0.5;    ///< Predicted at that distance; more is kClustered.
    double prior_gate_mm = 12.0;  ///< With a prior: how far off it may be at a marker.
  };
  static constexpr std::size_t kMaxHypotheses = 200000;
  static constexpr std::size_t kMaxCompared = 100'000'000;
  static constexpr std::size_t kMaxFitted = 32;  ///< Pairs that take part in the fit.

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_markers) noexcept {
    return 4 * Arena::bytes<std::uint16_t>(max_markers);
  }
  /// Errors:  kInvalidArgument, kOutOfMemory.
  [[nodiscard]] static Result<MarkerMatcher> make(const Config& config, std::size_t max_markers,
                                                  Arena& arena) noexcept;

  /// Markers beyond `max_markers` are not looked at.
  MatchReport run(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b,
                  const std::optional<geometry::RigidTransform>& prior_T_a_b) noexcept;
  /// Those of the last run; empty unless it was kMatched.
  [[nodiscard]] std::size_t num_pairs() const noexcept { return num_pairs_; }
  [[nodiscard]] MarkerPair pair(std::size_t i) const noexcept { return {pair_a_[i], pair_b_[i]}; }

 private:
  struct Search;

  explicit MarkerMatcher(const Config& config) noexcept : config_(config) {}
  [[nodiscard]] bool all_on_a_line(std::span<const Eigen::Vector3d> a,
                                   std::span<const Eigen::Vector3d> b) const noexcept;
  void refine(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b,
              MatchReport& report) noexcept;
  [[nodiscard]] MatchState judge(bool determined, const MatchReport& report) const noexcept;

  Config config_;
  std::span<std::uint16_t> assigned_;  ///< b's marker for each of a's, while a hypothesis is tried.
  std::span<std::uint16_t> best_;
  std::span<std::uint16_t> pair_a_;
  std::span<std::uint16_t> pair_b_;
  std::size_t num_pairs_ = 0;
};

}  // namespace dseam::markers
