// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/base/result.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/depth/depth_image.hpp"

namespace dseam::cloud {

/// Normals of a frame straight from its pixel grid, without a neighbour search.
///
/// A plane seen by a pinhole camera is linear in inverse depth over the pixels, so its normal is a
/// small linear fit over a window. Pixels beyond a depth step are left out of the window.
///
/// Frame:   camera; normals point to the camera.
/// Time:    O(window) a pixel, eight pixels at once.
/// Context: real-time safe; the stage has no state.
class OrganizedNormals {
 public:
  struct Config {
    std::uint32_t half_window = 3;     ///< Pixels to each side.
    float max_step_mm = 2.0F;          ///< Depth against the centre, for each pixel from it.
    std::uint32_t min_neighbours = 6;  ///< The pixel itself counts.
  };
  struct Normal {
    geometry::Vec3f direction;  ///< (0, 0, 0) where `state` is not kGood.
    float variation = 0.0F;  ///< Squared distance from the plane against the spread in the image.
    NormalState state = NormalState::kTooFew;
  };

  /// kInvalidArgument: half_window not in [1, 15], a max_step_mm that is not positive and finite.
  [[nodiscard]] static Result<OrganizedNormals> make(const Config& config) noexcept;

  /// One pixel; kTooFew outside the image and where there is no depth.
  [[nodiscard]] Normal at(const depth::DepthImage& image, std::uint32_t u,
                          std::uint32_t v) const noexcept;
  /// Row `v`, one entry a column; returns how many are good. An `out` shorter than the row is a
  /// broken precondition; an image whose spans do not fit its size has no good ones.
  std::uint32_t run_row(const depth::DepthImage& image, std::uint32_t v,
                        NormalsBuffer& out) const noexcept;

 private:
  struct Eight;
  explicit OrganizedNormals(const Config& config) noexcept : config_(config) {}
  [[nodiscard]] Eight fit_eight(const depth::DepthImage& image, std::uint32_t u,
                                std::uint32_t v) const noexcept;

  Config config_;
};

}  // namespace dseam::cloud
