// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/seam/open/open_candidate.hpp"
#include "dseam/seam/surface/surface_finder.hpp"

namespace dseam::seam {

/// Finds straight slits in planes: the gap between two plates that lie edge to edge.
///
/// The plane's points are projected on every direction in it, a quarter of a degree apart; a slit
/// shows as places without points between well filled ones. What is narrower than one and a half
/// spacings of the points does not show, and what something stands on all along is no gap.
///
/// Memory:  `bytes()` from the arena.
/// Time:    O(planes * directions * points), of which at most 32,768 are used.
class SlitFinder {
 public:
  struct Scale {
    double spacing_mm = 1.0;
    double tolerance_mm = 1.0;
  };

  [[nodiscard]] static constexpr std::size_t bytes() noexcept {
    return Arena::bytes<Flat>(kMaxPoints) + Arena::bytes<std::uint16_t>(kBins) +
           Arena::bytes<float>(kBins);
  }
  SlitFinder() = default;
  explicit SlitFinder(Arena& arena) noexcept
      : points_(arena.take<Flat>(kMaxPoints)),
        bins_(arena.take<std::uint16_t>(kBins)),
        smooth_(arena.take<float>(kBins)) {}

  /// Appends to `found` what it finds, the better one of two at one place.
  void run(const cloud::FusedCloudView& cloud, std::span<const FoundSurface> surfaces,
           const Scale& scale, const RingHint& hint, Buffer<OpenCandidate>& found) noexcept;
  /// The straight line along a slit that was found, with steps of `step_mm`.
  static void lay_track(const OpenCandidate& slit, double step_mm, SeamTrack& track) noexcept;

 private:
  static constexpr std::size_t kMaxPoints = 32768;
  static constexpr std::size_t kBins = 4096;
  struct Flat {
    float u = 0.0F;
    float v = 0.0F;
  };
  struct Slit {
    double depth = 0.0;  // How empty it is, summed over its width.
    double angle_rad = 0.0;
    double middle_mm = 0.0;
  };
  struct Sides {
    double start_mm = 0.0;
    double end_mm = 0.0;
    double coverage = 0.0;
    double lead = 0.0;  // Points on the positive side less those on the other.
  };

  double flatten(const cloud::FusedCloudView& cloud, const Surface& plane, double step_mm) noexcept;
  [[nodiscard]] Slit slit_along(double angle_rad, double spacing_mm) noexcept;
  [[nodiscard]] Slit judge(std::size_t first, std::size_t last, std::size_t reach) const noexcept;
  [[nodiscard]] Sides sides_of(const Slit& slit, double spacing_mm) noexcept;
  [[nodiscard]] bool is_built_over(const cloud::CloudView& cloud,
                                   const OpenCandidate& slit) noexcept;
  std::optional<OpenCandidate> consider(const cloud::FusedCloudView& cloud, const Surface& plane,
                                        const Scale& scale, const RingHint& hint) noexcept;

  Buffer<Flat> points_;
  std::span<std::uint16_t> bins_;
  std::span<float> smooth_;
  double bin_mm_ = 0.5;
  double low_mm_ = 0.0;
  std::size_t used_ = 0;
};

}  // namespace dseam::seam
