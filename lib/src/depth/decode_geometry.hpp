// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/depth/frame_decoder.hpp"
#include "raw_reader.hpp"

namespace dseam::depth {

/// The gray image of a raw frame; 0 everywhere when there is none.
class GrayReader {
 public:
  GrayReader(const DepthModel& model, std::span<const std::byte> bytes) noexcept
      : bytes_(model.has_gray && !bytes.empty() ? bytes.data() : nullptr),
        stride_(model.gray_row_stride_bytes == 0 ? model.intrinsics.width
                                                 : model.gray_row_stride_bytes) {}

  [[nodiscard]] std::uint8_t at(std::uint32_t column, std::uint32_t row) const noexcept {
    return bytes_ == nullptr ? std::uint8_t{0}
                             : std::to_integer<std::uint8_t>(bytes_[row * stride_ + column]);
  }

 private:
  const std::byte* bytes_;
  std::size_t stride_;
};

/// Where decoded pixels go, and the counts of what became of them.
class Canvas {
 public:
  Canvas(const Intrinsics& k, double mm_per_count, const ImageBuffers& out,
         FrameDecoder::Report& report) noexcept
      : k_(k), counts_per_mm_(1.0 / mm_per_count), out_(out), report_(report) {}

  [[nodiscard]] const Intrinsics& intrinsics() const noexcept { return k_; }
  void add_invalid() noexcept { ++report_.invalid; }
  void add_out_of_range() noexcept { ++report_.out_of_range; }
  /// Sets a pixel; of two points in one pixel the nearer stays.
  void put(std::uint32_t column, std::uint32_t row, double z_mm, std::uint8_t gray) noexcept;
  /// Gray without depth: where depth is missing, markers are still seen.
  void put_gray(std::uint32_t column, std::uint32_t row, std::uint8_t gray) noexcept;

 private:
  const Intrinsics& k_;
  double counts_per_mm_;
  const ImageBuffers& out_;
  FrameDecoder::Report& report_;
};

/// Pixel by pixel: projected depth, and disparity.
void decode_rays(const RawReader& in, const GrayReader& gray, const DepthModel& model,
                 Canvas& out) noexcept;
/// Backwards: each pixel's ray is followed to where it meets the height map.
void decode_grid(const RawReader& in, const GrayReader& gray, const DepthModel& model,
                 double reference_depth_mm, Canvas& out) noexcept;
/// Forwards: each point goes to the pixel it projects into.
void decode_points(const RawReader& in, const GrayReader& gray, Canvas& out) noexcept;

}  // namespace dseam::depth
