// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/result.hpp"
#include "dseam/depth/depth_image.hpp"
#include "dseam/geometry/ellipse.hpp"
#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::splice {

/// The smooth surface in one square block of pixels: depth as a quadratic of the pixel.
///
/// Units:   z = q . (1, x, y, x^2, x y, y^2) in mm, x and y being pixels from the block's centre
///          over half the block's side.
struct SurfacePatch {
  std::array<float, 6> q{};
  float rms_mm = 0.0F;
  std::uint16_t num_pixels = 0;  ///< 0: no smooth surface here.
};

/// All patches of one view: what splicing keeps of a frame.
///
/// Frame:   camera.
/// Shape:   `patches` has columns x rows entries row by row; block (i, j) covers the pixels
///          [i, i + 1) x [j, j + 1) times kBlockPx.
struct PatchField {
  static constexpr std::uint32_t kBlockPx = 12;

  depth::Intrinsics intrinsics;
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  std::span<const SurfacePatch> patches;

  [[nodiscard]] static constexpr std::size_t size_for(std::uint32_t width,
                                                      std::uint32_t height) noexcept {
    return std::size_t{width / kBlockPx} * (height / kBlockPx);
  }
  [[nodiscard]] Eigen::Vector2d centre_px(std::uint32_t column, std::uint32_t row) const noexcept {
    constexpr double kHalf = (kBlockPx - 1) / 2.0;
    return {column * double{kBlockPx} + kHalf, row * double{kBlockPx} + kHalf};
  }
  /// The patch under the pixel; nullptr outside and where there is no smooth surface.
  [[nodiscard]] const SurfacePatch* at(double u, double v) const noexcept;
};

/// A view in its present place.
struct PosedView {
  PatchField field;
  geometry::RigidTransform T_base_camera;
  geometry::RigidTransform T_camera_base;
  bool used = false;

  void place(const geometry::RigidTransform& pose) noexcept {
    T_base_camera = pose;
    T_camera_base = pose.inverse();
  }
};

/// A point of a patch and the surface's normal there, towards the camera.
struct SurfacePoint {
  bool valid = false;
  Eigen::Vector3d p_camera = Eigen::Vector3d::Zero();
  Eigen::Vector3d n_camera = Eigen::Vector3d::Zero();
};

/// Where the ray of the pixel meets the measured surface.
[[nodiscard]] SurfacePoint surface_at(const PatchField& field, double u, double v) noexcept;

/// Reduces a frame to its smooth patches: edges, flying pixels, grazing surfaces and the discs of
/// markers give none.
///
/// Frame:   camera.
/// Time:    O(pixels), three passes at most over each block.
class PatchExtractor {
 public:
  struct Config {
    double max_rms_mm = 0.25;        ///< Rougher blocks are edges, whatever the scanner's noise.
    double max_rms_to_median = 2.0;  ///< So are those much rougher than most.
    double min_filled = 0.75;        ///< Share of a block's pixels that lie on the surface.
    double min_facing = 0.25;        ///< Cosine between normal and ray.
    double ellipse_margin = 1.4;     ///< A marker's block counts as hidden up to this radius.
  };
  struct Report {
    std::uint32_t blocks = 0;
    std::uint32_t smooth = 0;
    double median_rms_mm =
        0.0;  ///< Of the pixels about their patch: the scanner's short-range noise.
  };

  explicit PatchExtractor(const Config& config) noexcept : config_(config) {}

  /// Shape:   `out` has PatchField::size_for(width, height) entries. Fewer, or depth of another
  ///          size: nothing is written, no blocks are reported.
  Report run(const depth::DepthImage& frame, std::span<const geometry::Ellipse> hidden,
             std::span<SurfacePatch> out) const noexcept;

 private:
  Config config_;
};

}  // namespace dseam::splice
