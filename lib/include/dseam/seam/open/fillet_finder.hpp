// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/seam/open/open_candidate.hpp"
#include "dseam/seam/surface/surface_finder.hpp"

namespace dseam::seam {

/// Finds the lines in which two surfaces meet at an angle, with the air between them.
///
/// From the place where both come nearest, the line in which two surfaces cross is walked both ways
/// as long as cells of both lie beside it; a line that comes back to its start is a ring and no
/// open seam. Where the cameras' places are known, edges that are seen from outside drop out.
///
/// Memory:  `bytes()` from the arena.
/// Time:    O(pairs of surfaces * cells + stations * cells near them).
class FilletFinder {
 public:
  struct Scale {
    double cell_mm = 4.0;
    double tolerance_mm = 1.0;
  };

  [[nodiscard]] static constexpr std::size_t bytes() noexcept {
    return Arena::bytes<NearCell>(kMaxNear) + SeamTrack::bytes();
  }
  FilletFinder() = default;
  explicit FilletFinder(Arena& arena) noexcept
      : near_(arena.take<NearCell>(kMaxNear)), track_(arena) {}

  /// Appends to `found` what it finds.
  void run(std::span<const Cell> cells, std::span<const FoundSurface> surfaces, const Scale& scale,
           const RingHint& hint, Buffer<OpenCandidate>& found) noexcept;
  /// The seam of a joint as a track; empty where it is none after all.
  const SeamTrack& walk(std::span<const Cell> cells, const OpenJoint& joint,
                        const Scale& scale) noexcept;

 private:
  static constexpr std::size_t kMaxNear = 8192;
  struct NearCell {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    std::uint8_t side = 0;
    double away_mm = 0.0;  // Signed, from the other surface.
    cloud::ViewMask seen_by = 0;
  };
  struct Support {
    bool both = false;
    bool any = false;
  };

  void gather(std::span<const Cell> cells, const OpenJoint& joint, const Scale& scale) noexcept;
  [[nodiscard]] bool choose_sides(OpenJoint& joint, const Scale& scale) noexcept;
  [[nodiscard]] bool is_seen_from_outside(const OpenJoint& joint,
                                          const RingHint& hint) const noexcept;
  [[nodiscard]] Support support_at(const OpenJoint& joint, const SeamTrack::Station& at,
                                   double step_mm) const noexcept;
  [[nodiscard]] std::optional<Eigen::Vector3d> seed(const OpenJoint& joint) const noexcept;
  void trace(const OpenJoint& joint, const Scale& scale) noexcept;
  bool extend(const OpenJoint& joint, const Eigen::Vector3d& start, double step_mm) noexcept;
  [[nodiscard]] double width_of(std::size_t side) noexcept;
  std::optional<OpenCandidate> consider(std::span<const Cell> cells, OpenJoint joint,
                                        const Scale& scale, const RingHint& hint) noexcept;

  Buffer<NearCell> near_;
  SeamTrack track_;
};

}  // namespace dseam::seam
