// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/seam/joint/foot_search.hpp"
#include "dseam/seam/joint/joint.hpp"
#include "dseam/seam/seam_report.hpp"
#include "dseam/seam/surface/surface_finder.hpp"

namespace dseam::seam {

/// What the caller knows of the ring beforehand.
struct RingHint {
  bool has_region = false;
  Eigen::Vector3d region_min = Eigen::Vector3d::Zero();
  Eigen::Vector3d region_max = Eigen::Vector3d::Zero();
  double radius_mm = 0.0;                         ///< 0: any.
  std::span<const Eigen::Vector3d> viewpoints{};  ///< The cameras' places, where they are known.
};

/// Forms every ring in which a cylinder or cone leaves another surface, and chooses the seam.
///
/// A ring counts by the length along which both surfaces are seen, the shell outside the nozzle
/// and the nozzle above the shell, times the share of the turn that this is: a rim, a bolt hole or
/// a contact with the table has nothing there, and a large ring is seldom seen by chance all round.
///
/// Time:    O(pairs of surfaces * cells).
class RingFinder {
 public:
  static constexpr int kBins = 72;
  struct Choice {
    Refusal refusal = Refusal::kNoRing;
    Joint joint;
    std::optional<Surface> bore;  ///< The inside of the nozzle's wall, if it was seen.
  };

  [[nodiscard]] static constexpr std::size_t bytes() noexcept {
    return Arena::bytes<RingCandidate>(kMaxRings) + Arena::bytes<Joint>(kMaxRings) +
           Arena::bytes<FootSearch::Found>(kMaxFeet) + FootSearch::bytes();
  }
  RingFinder() = default;
  explicit RingFinder(Arena& arena) noexcept
      : rings_(arena.take<RingCandidate>(kMaxRings)),
        joints_(arena.take<Joint>(kMaxRings)),
        feet_(arena.take<FootSearch::Found>(kMaxFeet)),
        foot_(arena) {}

  Choice run(std::span<const Cell> cells, std::span<const FoundSurface> surfaces,
             const CellScale& scale, const RingHint& hint, SeamReport& report) noexcept;
  /// The same where too little was seen: of the largest nozzles each stands on the plane that is
  /// found at its foot. `cells` and `surfaces` are those of the cloud.
  Choice run_at_feet(const cloud::CloudView& cloud, std::span<const Cell> cells,
                     std::span<const FoundSurface> surfaces, const CellScale& scale,
                     const RingHint& hint, SeamReport& report) noexcept;

 private:
  static constexpr std::size_t kMaxRings = 64;
  static constexpr std::size_t kMaxFeet = 8;
  void clear(double half_cell_mm) noexcept;
  void keep_foot(const FootSearch::Found& found) noexcept;
  void consider(std::span<const Cell> cells, const Joint& joint, const CellScale& scale,
                const RingHint& hint) noexcept;
  void keep(const RingCandidate& ring, const Joint& joint) noexcept;
  [[nodiscard]] bool is_bore(const RingCandidate& ring) const noexcept;
  [[nodiscard]] std::optional<Surface> bore_of(std::size_t chosen) const noexcept;
  Choice choose(SeamReport& report) noexcept;

  Buffer<RingCandidate> rings_;
  Buffer<Joint> joints_;
  Buffer<FootSearch::Found> feet_;
  FootSearch foot_;
  double half_cell_mm_ = 0.0;  // How far to both sides of its mean a cell tells of the ring.
};

}  // namespace dseam::seam
