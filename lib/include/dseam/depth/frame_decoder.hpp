// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/result.hpp"
#include "dseam/depth/depth_image.hpp"
#include "dseam/depth/depth_model.hpp"

namespace dseam::depth {

/// A frame as the device delivered it; `DepthModel` says how to read it.
struct RawFrame {
  std::span<const std::byte> depth;
  std::span<const std::byte> gray;
};

/// Lent memory for one decoded frame; `gray` may be empty when the camera gives none.
struct ImageBuffers {
  std::span<std::uint16_t> depth;
  std::span<std::uint8_t> gray;
};

/// Turns the frames of any depth camera into 16-bit z images on a pinhole's pixels.
///
/// Formats that carry their own x and y are brought onto the pinhole's pixels: an even grid by
/// looking up where each pixel's ray meets it, single points by the pixel they fall into, the
/// nearest winning. The gray value moves with its depth.
///
/// Shape:   in: depth_bytes(model) at least; out: width * height each.
/// Memory:  lent by the caller; the decoder itself is a value.
/// Time:    O(pixels); at most 8 steps a pixel for an even grid.
/// Errors:  make(): kInvalidArgument: a size, scale, unit, stride or focal length out of range;
///          kUnsupported: a geometry that the format cannot carry.
class FrameDecoder {
 public:
  struct Config {
    double max_depth_mm = 1024.0;       ///< Sets the count where the format does not.
    double reference_depth_mm = 400.0;  ///< Where a grid's cell is to cover one pixel.
  };

  /// kTruncated: the payload is shorter than the model promises; the output is all invalid.
  enum class Fault : std::uint8_t { kNone, kTruncated, kTruncatedGray };

  struct Report {
    Fault fault = Fault::kNone;
    std::uint32_t valid = 0;
    std::uint32_t invalid = 0;       ///< Marked so by the device, or not a number.
    std::uint32_t out_of_range = 0;  ///< Behind the camera, beyond 16 bits, or off the image.
    std::uint32_t hidden = 0;        ///< Another point of the same pixel was nearer.
  };

  static Result<FrameDecoder> make(const DepthModel& model, const Config& config) noexcept;
  static Result<FrameDecoder> make(const DepthModel& model) noexcept { return make(model, {}); }

  Report run(const RawFrame& in, const ImageBuffers& out) const noexcept;

  /// The decoded frame that lies in `buffers`.
  [[nodiscard]] DepthImage image(const ImageBuffers& buffers) const noexcept;
  [[nodiscard]] const Intrinsics& intrinsics() const noexcept { return intrinsics_; }
  [[nodiscard]] double mm_per_count() const noexcept { return mm_per_count_; }
  [[nodiscard]] std::size_t pixels() const noexcept {
    return std::size_t{intrinsics_.width} * intrinsics_.height;
  }

 private:
  FrameDecoder(const DepthModel& model, const Config& config) noexcept;

  DepthModel model_;
  Intrinsics intrinsics_;
  double mm_per_count_;
  double reference_depth_mm_;
};

}  // namespace dseam::depth
