// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "dseam/depth/frame_decoder.hpp"
#include "dseam/depth/sample_layout.hpp"

namespace {

using dseam::depth::DepthModel;

/// What the input begins with; the rest is the frame.
struct Header {
  std::uint8_t format;
  std::uint8_t geometry;
  std::uint8_t width;
  std::uint8_t height;
  std::uint8_t flags;
  std::uint8_t row_padding;
  std::uint8_t gray_padding;
  std::uint8_t gray_share;
  std::array<double, 13> numbers;
};

DepthModel model_of(const Header& header) {
  DepthModel model;
  const auto& n = header.numbers;
  model.format = static_cast<dseam::depth::SampleFormat>(header.format % 8);
  model.geometry = static_cast<dseam::depth::Geometry>(header.geometry % 5);
  model.intrinsics = {header.width, header.height, n[0], n[1], n[2], n[3]};
  model.scale = {n[4], n[5], n[6]};
  model.offset = {n[7], n[8], n[9]};
  model.invalid_value = n[10];
  model.mm_per_unit = n[11];
  model.baseline_mm = n[12];
  model.has_invalid_value = (header.flags & 1U) != 0;
  model.has_gray = (header.flags & 2U) != 0;
  if ((header.flags & 4U) != 0) {
    model.row_stride_bytes =
        static_cast<std::uint32_t>(dseam::depth::row_bytes(model)) + header.row_padding;
    model.gray_row_stride_bytes = std::uint32_t{header.width} + header.gray_padding;
  }
  return model;
}

}  // namespace

/// No frame is read out of bounds, and every pixel of a whole frame is accounted for.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Header header{};
  if (size < sizeof header) {
    return 0;
  }
  std::memcpy(&header, data, sizeof header);
  const auto decoder = dseam::depth::FrameDecoder::make(model_of(header));
  if (!decoder.ok()) {
    return 0;
  }
  // Copies of the exact sizes, so that a sanitizer sees the first byte past either.
  const auto rest = std::as_bytes(std::span(data, size)).subspan(sizeof header);
  const std::size_t gray_size = rest.size() * header.gray_share / 255;
  const std::vector<std::byte> gray(rest.begin(), rest.begin() + std::ptrdiff_t(gray_size));
  const std::vector<std::byte> depth(rest.begin() + std::ptrdiff_t(gray_size), rest.end());
  std::vector<std::uint16_t> counts(decoder.value().pixels());
  std::vector<std::uint8_t> shades(decoder.value().pixels());
  const auto report = decoder.value().run({depth, gray}, {counts, shades});
  const std::uint64_t seen =
      std::uint64_t{report.valid} + report.invalid + report.out_of_range + report.hidden;
  if (report.fault != dseam::depth::FrameDecoder::Fault::kTruncated && seen != counts.size()) {
    std::abort();
  }
  return 0;
}
