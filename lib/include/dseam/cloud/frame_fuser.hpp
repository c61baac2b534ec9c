// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/crop_box.hpp"
#include "dseam/cloud/voxel_map.hpp"
#include "dseam/depth/depth_image.hpp"
#include "dseam/geometry/transform3f.hpp"

namespace dseam::cloud {

/// Decodes a depth frame, crops it, takes it to base and fuses it into a voxel map in one pass.
///
/// Memory:  4 bytes a column.
/// Time:    O(pixels).
/// Context: real-time safe; one thread at a time.
class FrameFuser {
 public:
  struct Config {
    OrientedBox box{};               ///< Of the base frame; endless at first.
    float max_step_mm = 0.0F;        ///< Flying pixels: see below. 0 keeps all.
    std::uint32_t pixel_stride = 1;  ///< Every n-th pixel of every n-th row.
  };
  struct Report {
    std::uint32_t pixels = 0;  ///< Looked at.
    std::uint32_t without_depth = 0;
    std::uint32_t dropped_masked = 0;
    std::uint32_t dropped_flying = 0;
    std::uint32_t dropped_outside = 0;  ///< Not in the box.
    VoxelMap::Report map;
  };
  struct View {
    depth::DepthImage image;
    geometry::RigidTransform T_base_camera;
    std::size_t number = 0;                ///< Under kMaxViews.
    std::span<const std::uint8_t> masked;  ///< Pixels with other than 0 are skipped; or empty.
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_width) noexcept {
    return Arena::bytes<float>(max_width + lanes::kLanes);
  }
  /// kInvalidArgument: a box that is not sensible, a negative or not finite max_step_mm, a stride
  /// or a width of 0. kOutOfMemory: the arena is too small.
  [[nodiscard]] static Result<FrameFuser> make(const Config& config, std::size_t max_width,
                                               Arena& arena) noexcept;

  /// Errors:  a box that is not sensible is a broken precondition.
  void set_box(const OrientedBox& box) noexcept;

  /// A pixel flies when its depth is further than max_step_mm from both horizontal neighbours or
  /// from both vertical ones (a neighbour without depth counts as far): such a pixel mixes two
  /// surfaces, while the pixel at a true edge has one neighbour on its own.
  ///
  /// Errors:  an image wider than max_width, or whose spans do not fit its size, is fused not at
  ///          all: the report has no pixels.
  Report run(const View& view, VoxelMap& map) noexcept;

 private:
  struct Frame;
  FrameFuser(const Config& config, std::span<float> ray_x) noexcept
      : config_(config), ray_x_(ray_x) {}
  void fuse_row(const Frame& frame, std::uint32_t v, VoxelMap& map, Report& report) const noexcept;

  Config config_;
  std::span<float> ray_x_;  ///< Tangent of each column's angle, of every stride-th column.
};

}  // namespace dseam::cloud
