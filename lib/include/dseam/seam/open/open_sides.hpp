// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/seam/open/along_model.hpp"
#include "dseam/seam/open/open_joint.hpp"
#include "dseam/seam/seam_report.hpp"

namespace dseam::seam {

/// The two sides of an open seam as the cloud's points near it show them: surfaces, their
/// deviations along the seam, where they end beside it, and where the seam begins and ends.
///
/// Frame:   that of the cloud.
/// Memory:  `bytes()` from the arena.
/// Time:    O(points near the seam * stations / 8).
class OpenSides {
 public:
  static constexpr std::size_t kMaxBins = 512;

  struct Point {
    Eigen::Vector3f from_pivot = Eigen::Vector3f::Zero();
    float s_mm = 0.0F;
    float away_mm = 0.0F;
    float off_mm = 0.0F;   ///< From the fitted surface...
    float rest_mm = 0.0F;  ///< ...and from its deviation.
  };
  struct Side {
    Buffer<Point> points;
    AlongModel deviation;
    AlongModel edge;  ///< Fitted where the side ends beside the seam: away() of its edge.
    double cut_mm = 1.0;
  };
  struct Scale {
    double spacing_mm = 1.0;
    double tolerance_mm = 1.0;
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_points) noexcept {
    return 2 * Arena::bytes<Point>(max_points / 2) + Arena::bytes<float>(max_points / 2) +
           Arena::bytes<Sum>(kMaxBins * kRows) +
           Arena::bytes<AlongModel::Sample>(kMaxBins * kRows) + Arena::bytes<Nearest>(kMaxBins);
  }
  OpenSides() = default;
  OpenSides(std::size_t max_points, Arena& arena) noexcept;

  /// Refines `joint` and `track`; false where a side has too few points beside the seam.
  bool run(const cloud::CloudView& cloud, const Scale& scale, OpenJoint& joint,
           SeamTrack& track) noexcept;

  [[nodiscard]] const Side& side(std::size_t i) const noexcept { return sides_[i]; }
  [[nodiscard]] std::uint32_t num_dropped() const noexcept { return num_dropped_; }
  /// Arc lengths on the track between which both sides are there.
  [[nodiscard]] double start_mm() const noexcept { return start_mm_; }
  [[nodiscard]] double end_mm() const noexcept { return end_mm_; }
  /// How well the two ends are known, along the seam; one standard deviation.
  [[nodiscard]] double end_sigma_mm() const noexcept { return end_sigma_mm_; }
  /// -1 at the start and 1 at the end.
  [[nodiscard]] double along_of(double s_mm) const noexcept {
    return 2.0 * (s_mm - start_mm_) / (end_mm_ - start_mm_) - 1.0;
  }
  /// True where trusted points of both sides lie within 3 mm of the seam, plus its dead band.
  [[nodiscard]] bool measured_at(double s_mm) const noexcept;
  /// The stretches without measurement as shares of a turn, from the end where travel starts.
  void report(bool forward, SeamReport& report) const noexcept;
  /// Residuals of the points within 6 mm of the seam.
  [[nodiscard]] ResidualStats stats_of(std::size_t side) noexcept;

 private:
  static constexpr std::size_t kRows = 4;
  static constexpr std::size_t kNearest = 6;
  struct Sum {
    double s = 0.0, away = 0.0, off = 0.0, weight = 0.0;
  };
  struct Nearest {
    std::array<float, kNearest> away_mm{};
  };
  struct Ends {
    double start_mm = 0.0;
    double end_mm = 0.0;
    double scatter_mm = 0.0;
  };

  void select(const cloud::CloudView& cloud, const OpenJoint& joint, const SeamTrack& track,
              double tolerance_mm) noexcept;
  bool refine(std::size_t side, OpenJoint& joint) noexcept;
  void measure(std::size_t side, const OpenJoint& joint) noexcept;
  [[nodiscard]] double cut_of(const Side& side) noexcept;
  [[nodiscard]] Ends ends_of(const Side& side) noexcept;
  bool find_ends() noexcept;
  bool model(Side& side) noexcept;
  void collect_nearest(const Side& side) noexcept;
  void find_edge(Side& side) noexcept;
  std::size_t without_strays(std::span<AlongModel::Sample> samples) noexcept;
  void keep_edges(OpenKind kind) noexcept;
  void find_coverage() noexcept;

  Eigen::Vector3d pivot_ = Eigen::Vector3d::Zero();
  std::array<Side, 2> sides_;
  std::span<float> scratch_;
  std::span<Sum> sums_;
  std::span<AlongModel::Sample> samples_;
  std::span<Nearest> nearest_;
  std::array<bool, kMaxBins> measured_{};
  std::size_t num_bins_ = 0;
  std::uint32_t num_dropped_ = 0;
  double spacing_mm_ = 1.0;
  double start_mm_ = 0.0;
  double end_mm_ = 0.0;
  double end_sigma_mm_ = 0.0;
};

}  // namespace dseam::seam
