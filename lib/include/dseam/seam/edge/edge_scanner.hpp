// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/depth/depth_image.hpp"
#include "dseam/seam/edge/edge_curve.hpp"
#include "dseam/seam/edge/ending_surface.hpp"
#include "dseam/splice/spliced_view.hpp"

namespace dseam::seam {

/// Looks in the raw frames for places where a surface ends beside the other one and something
/// behind it is seen: the shell's edge at a gap, or the end of a nozzle that stands off the shell.
///
/// Rows and columns are walked. A pixel counts as behind only when its neighbour goes on from it,
/// so that a flying pixel is never an end of an interval; a dropped pixel only makes one wider.
/// A dead band shows nothing behind the surface and therefore is no gap.
///
/// Memory:  `bytes()` from the arena.
/// Time:    O(pixels near the joint).
class EdgeScanner {
 public:
  static constexpr std::size_t kMaxLine = 4096;  ///< Longer rows are cut off.

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_intervals) noexcept {
    return Arena::bytes<EdgeInterval>(max_intervals) + Arena::bytes<Pixel>(kMaxLine) +
           Arena::bytes<std::uint8_t>(std::size_t{kBlocksAcross} * kBlocksAcross) +
           Arena::bytes<Nearest>(kBins);
  }
  EdgeScanner() = default;
  EdgeScanner(std::size_t max_intervals, Arena& arena) noexcept
      : intervals_(arena.take<EdgeInterval>(max_intervals)),
        line_(arena.take<Pixel>(kMaxLine)),
        blocks_(arena.take<std::uint8_t>(std::size_t{kBlocksAcross} * kBlocksAcross)),
        nearest_(arena.take<Nearest>(kBins)) {}

  /// `noise_mm` is that of the fused points; a single pixel's is measured here.
  void run(std::span<const depth::DepthImage> frames, std::span<const splice::SplicedView> views,
           const EndingSurface& surface, double noise_mm) noexcept;
  /// The same from the fused points alone: where the surface's points thin out towards the other
  /// one although the other's own points go on. Less exact, by a share of the points' spacing.
  void run(const EndingSurface& surface, double spacing_mm) noexcept;
  /// True when there were more intervals than room for them.
  [[nodiscard]] bool full() const noexcept { return full_; }
  [[nodiscard]] std::span<const EdgeInterval> intervals() const noexcept {
    return intervals_.view();
  }
  /// The length over which all intervals may err alike; 0 for a sharp edge in the frames.
  [[nodiscard]] double smear_mm() const noexcept { return smear_mm_; }

 private:
  enum class Kind : std::uint8_t { kNothing, kSurface, kBehind, kOther };
  struct Pixel {
    Kind kind = Kind::kNothing;
    float z_mm = 0.0F;
  };
  static constexpr double kSurfaceShare =
      0.6;  // Of the margin: between the two a pixel tells nothing.
  static constexpr std::uint32_t kBlock = 8;  // Pixels across a block.
  static constexpr std::uint32_t kBlocksAcross = kMaxLine / kBlock;
  static constexpr std::size_t kBins = 120;
  static constexpr std::size_t kNearest = 6;
  // The surface's points nearest to the other one in one bin of the angle, and the other's nearest.
  struct Nearest {
    std::array<double, kNearest> surface_mm{};
    double other_mm = 0.0;
  };
  struct Window {
    std::uint32_t u0 = 0, v0 = 0, u1 = 0, v1 = 0;  // The last ones are excluded.
  };
  struct PixelPlace {
    std::uint32_t u, v;
  };
  struct Step {
    std::uint32_t u, v;
    bool along_u;
  };
  struct Walk {
    std::size_t last, sure;  // The surface's last pixel, and the first one that is sure beneath it.
    std::size_t count;       // Of the line's pixels.

    [[nodiscard]] bool has(std::size_t i, std::size_t beyond) const noexcept {
      return sure > last ? i + beyond < count : i >= beyond;
    }
    [[nodiscard]] std::size_t at(std::size_t i, std::size_t beyond) const noexcept {
      return sure > last ? i + beyond : i - beyond;
    }
  };

  // What the lines that were walked say of the edge: sharp, bevelled, or smeared by the scanner.
  struct EdgeShape {
    std::size_t pairs = 0;
    std::size_t bevelled = 0;
    std::size_t shallow = 0;  // Those that go down by and by, bevelled or not.
    double runs = 0.0;        // Of the bevelled: the sum of what each runs back for a mm that it
    double squares = 0.0;     // falls, and of its squares.
    double reach_mm = 0.0;    // So far over a bevel a pixel cannot be told from the surface.
    bool is_smeared = false;
  };

  void scan(std::span<const depth::DepthImage> frames,
            std::span<const splice::SplicedView> views) noexcept;
  [[nodiscard]] double pixel_noise_mm(std::span<const depth::DepthImage> frames,
                                      std::span<const splice::SplicedView> views) noexcept;
  [[nodiscard]] double off_surface_mm(const depth::DepthImage& frame, std::uint32_t u,
                                      std::uint32_t v) const noexcept;
  void collect_nearest(const EndingSurface& surface) noexcept;
  [[nodiscard]] Window window_of(const depth::Intrinsics& k) noexcept;
  void mark(const PixelPlace& at, const depth::Intrinsics& k, Window& w) noexcept;
  [[nodiscard]] std::uint32_t stride_of(const depth::Intrinsics& k) const noexcept;
  [[nodiscard]] Pixel classify(const depth::DepthImage& frame, std::uint32_t u,
                               std::uint32_t v) const noexcept;
  void scan_line(const depth::DepthImage& frame, const Step& start, std::size_t count) noexcept;
  void try_pair(const depth::DepthImage& frame, const Step& start, std::size_t last,
                std::size_t behind, std::size_t count) noexcept;
  [[nodiscard]] std::optional<std::size_t> first_sure(std::size_t last, std::size_t behind,
                                                      std::size_t count) const noexcept;
  [[nodiscard]] bool goes_on(std::size_t last, std::size_t behind,
                             std::size_t count) const noexcept;
  [[nodiscard]] double past_edge_mm(const depth::DepthImage& frame, const Step& start,
                                    std::size_t i, const Eigen::Vector3d& p) const noexcept;
  [[nodiscard]] std::optional<Eigen::Vector3d> on_surface(const depth::DepthImage& frame,
                                                          const Step& start,
                                                          std::size_t i) const noexcept;

  [[nodiscard]] Eigen::Vector3d ray_base(const depth::DepthImage& frame, const Step& start,
                                         std::size_t i) const noexcept;
  [[nodiscard]] std::optional<Eigen::Vector2d> place_of(const depth::DepthImage& frame,
                                                        const Step& start,
                                                        std::size_t i) const noexcept;
  [[nodiscard]] Eigen::Vector2d foot_of_bevel(const depth::DepthImage& frame, const Step& start,
                                              const Walk& walk,
                                              const Eigen::Vector2d& top) const noexcept;
  [[nodiscard]] std::optional<EdgeInterval> at_bevel(const depth::DepthImage& frame,
                                                     const Step& start, const Walk& walk,
                                                     const EdgeInterval& seen) noexcept;
  [[nodiscard]] std::size_t steepest(const depth::DepthImage& frame, const Step& start,
                                     const Walk& walk) const noexcept;
  [[nodiscard]] EdgeInterval by_shape(const depth::DepthImage& frame, const Step& start,
                                      const Walk& walk, const EdgeInterval& seen) noexcept;
  [[nodiscard]] bool look_again() noexcept;
  [[nodiscard]] double mean_width_mm() const noexcept;

  EndingSurface surface_;
  geometry::RigidTransform T_base_camera_;
  double margin_mm_ = 0.1;
  EdgeShape shape_;
  double smear_mm_ = 0.0;
  bool full_ = false;
  Buffer<EdgeInterval> intervals_;
  std::span<Pixel> line_;
  std::span<std::uint8_t> blocks_;  // Of the image: 1 where the joint is near.
  std::span<Nearest> nearest_;
};

}  // namespace dseam::seam
