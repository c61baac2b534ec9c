// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/base/result.hpp"
#include "dseam/depth/depth_model.hpp"

namespace dseam::depth {

/// How many samples a pixel has, how wide they are and whether each coordinate has its own plane.
/// The last sample of a pixel is z; of three samples the second is y; of several the first is x.
struct SampleLayout {
  std::uint8_t samples = 1;
  std::uint8_t sample_bytes = 2;
  bool planar = false;

  [[nodiscard]] constexpr std::uint32_t pixel_bytes() const noexcept {
    return planar ? sample_bytes : std::uint32_t{samples} * sample_bytes;
  }
  [[nodiscard]] constexpr bool is_float() const noexcept { return sample_bytes == 4; }
};

[[nodiscard]] SampleLayout layout_of(SampleFormat format) noexcept;

/// Bytes from one row to the next, in each plane.
[[nodiscard]] std::uint64_t row_bytes(const DepthModel& model) noexcept;
/// The smallest payload that holds the whole depth frame; the last row needs no padding.
[[nodiscard]] std::uint64_t depth_bytes(const DepthModel& model) noexcept;
/// The smallest payload that holds the gray frame, 0 when there is none.
[[nodiscard]] std::uint64_t gray_bytes(const DepthModel& model) noexcept;

/// The format that a GenICam pixel format code (PFNC) stands for.
///
/// Errors:  kUnsupported: packed, 8-bit, without a z sample, or no depth format at all.
[[nodiscard]] Result<SampleFormat> format_from_pfnc(std::uint32_t code) noexcept;
/// The format that a V4L2 four-character code stands for.
///
/// Errors:  kUnsupported, as above; Y16 in big endian too.
[[nodiscard]] Result<SampleFormat> format_from_fourcc(std::uint32_t code) noexcept;
/// V4L2's four characters as one number.
[[nodiscard]] constexpr std::uint32_t fourcc(char a, char b, char c, char d) noexcept {
  return static_cast<std::uint32_t>(static_cast<unsigned char>(a)) |
         static_cast<std::uint32_t>(static_cast<unsigned char>(b)) << 8U |
         static_cast<std::uint32_t>(static_cast<unsigned char>(c)) << 16U |
         static_cast<std::uint32_t>(static_cast<unsigned char>(d)) << 24U;
}

}  // namespace dseam::depth
