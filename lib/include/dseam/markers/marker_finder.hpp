// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/depth/depth_image.hpp"
#include "dseam/markers/blob_finder.hpp"
#include "dseam/markers/marker.hpp"
#include "dseam/markers/ring_pixels.hpp"

namespace dseam::markers {

struct EllipseEdge;

/// Finds round marker discs in the gray image, and their centres in space from the depth around.
///
/// Frame:   camera.
/// Memory:  the blob finder's and 50 kB, from the arena.
/// Time:    O(pixels) with a small constant, then O(candidates).
/// Errors:  a frame without gray or of another size gives no markers and says so in the report.
class MarkerFinder {
 public:
  struct Config {
    BlobFinder::Config blobs;
    double min_radius_mm = 1.3;
    double max_radius_mm = 5.6;
    double min_half_axis_px = 2.0;
    double min_axis_ratio = 0.4;           ///< Flatter ellipses are seen at too grazing an angle.
    double max_fill_error = 0.2;           ///< Of the blob's area against its ellipse's.
    double max_edge_rms_of_radius = 0.07;  ///< Of the rim's points about the ellipse.
    double min_rim_seen = 0.95;            ///< Share of the rim with an edge: no partial discs.
    double min_contrast = 25.0;            ///< Gray values across the rim.
    double max_unevenness = 0.25;          ///< Of the step along the rim, and inside the disc.
    double max_edge_width_px = 4.5;        ///< Softer edges belong to specular spots.
    double max_hole_depth_mm = 0.5;        ///< Depth inside that lies further off is a hole.
    double sigma_depth_mm = 0.02;  ///< Of one depth, the share that neighbours have in common.
  };
  struct Report {
    bool gray_usable = false;
    BlobFinder::Report blobs;
    std::uint32_t candidates = 0;
    std::uint32_t rejected_shape = 0;
    std::uint32_t rejected_edge = 0;     ///< Partial, soft, or not an ellipse.
    std::uint32_t rejected_surface = 0;  ///< No surface around it, or not a circle on it.
    std::uint32_t rejected_hole = 0;
    std::uint32_t rejected_size = 0;
    std::uint32_t found = 0;
    std::uint32_t not_stored = 0;  ///< Found, but `out` was full.
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::uint32_t width) noexcept {
    return BlobFinder::bytes(width) + RingPixels::bytes();
  }
  /// Errors:  kInvalidArgument, kOutOfMemory.
  [[nodiscard]] static Result<MarkerFinder> make(const Config& config, std::uint32_t width,
                                                 Arena& arena) noexcept;

  Report run(const depth::DepthImage& frame, Buffer<Marker>& out) noexcept;

 private:
  MarkerFinder(const Config& config, std::uint32_t width, BlobFinder blobs, Arena& arena) noexcept
      : config_(config), width_(width), blobs_(blobs), ring_(arena) {}
  void examine(const depth::DepthImage& frame, const Blob& blob, Report& report,
               Buffer<Marker>& out) noexcept;
  bool lay(const depth::DepthImage& frame, const EllipseEdge& edge, Marker& marker,
           Report& report) noexcept;

  Config config_;
  std::uint32_t width_;
  BlobFinder blobs_;
  RingPixels ring_;
};

}  // namespace dseam::markers
