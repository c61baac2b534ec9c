// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <span>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/depth/frame_decoder.hpp"
#include "dseam/depth/sample_layout.hpp"

namespace dseam::test {

/// Writes raw frames sample by sample, from the definition of the formats and not from the decoder.
class RawFrameBuilder {
 public:
  explicit RawFrameBuilder(const depth::DepthModel& model)
      : model_(model), bytes_(depth::depth_bytes(model)) {}

  RawFrameBuilder& set(std::uint32_t column, std::uint32_t row,
                       std::initializer_list<double> samples) {
    std::size_t index = 0;
    for (const double sample : samples) {
      write(place(column, row, index, samples.size()), sample);
      ++index;
    }
    return *this;
  }
  RawFrameBuilder& fill(std::initializer_list<double> samples) {
    for (std::uint32_t row = 0; row < model_.intrinsics.height; ++row) {
      for (std::uint32_t column = 0; column < model_.intrinsics.width; ++column) {
        set(column, row, samples);
      }
    }
    return *this;
  }
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

 private:
  [[nodiscard]] bool is_float() const {
    using enum depth::SampleFormat;
    return model_.format == kC32f || model_.format == kABC32f || model_.format == kABC32fPlanar;
  }
  [[nodiscard]] bool is_planar() const {
    using enum depth::SampleFormat;
    return model_.format == kAC16Planar || model_.format == kABC16Planar ||
           model_.format == kABC32fPlanar;
  }
  [[nodiscard]] std::byte* place(std::uint32_t column, std::uint32_t row, std::size_t index,
                                 std::size_t count) {
    const std::size_t size = is_float() ? 4 : 2;
    const std::size_t pixel = is_planar() ? size : size * count;
    const std::size_t stride = model_.row_stride_bytes != 0
                                   ? model_.row_stride_bytes
                                   : std::size_t{model_.intrinsics.width} * pixel;
    const std::size_t plane = is_planar() ? stride * model_.intrinsics.height : size;
    return bytes_.data() + row * stride + column * pixel + index * plane;
  }
  void write(std::byte* place, double sample) const {
    if (is_float()) {
      const auto value = static_cast<float>(sample);
      std::memcpy(place, &value, sizeof value);
    } else {
      const auto value = static_cast<std::uint32_t>(sample + 0.5);
      place[0] = std::byte(value & 0xFFU);
      place[1] = std::byte(value >> 8U);
    }
  }

  depth::DepthModel model_;
  std::vector<std::byte> bytes_;
};

/// A decoded frame with its memory.
struct Decoded {
  std::vector<std::uint16_t> counts;
  std::vector<std::uint8_t> shades;
  depth::DepthImage image;
  depth::FrameDecoder::Report report;

  [[nodiscard]] double z_mm(std::uint32_t u, std::uint32_t v) const {
    return image.count_at(u, v) * image.mm_per_count;
  }
};

inline Decoded decode(const depth::DepthModel& model, std::span<const std::byte> depth,
                      std::span<const std::byte> gray = {}) {
  const auto decoder = depth::FrameDecoder::make(model).value();
  Decoded out;
  out.counts.resize(decoder.pixels());
  out.shades.resize(decoder.pixels());
  out.report = decoder.run({depth, gray}, {out.counts, out.shades});
  out.image = decoder.image({out.counts, out.shades});
  return out;
}

/// Any model, sensible or not: every field takes ordinary and absurd values.
inline depth::DepthModel random_model(Pcg32& random) {
  constexpr double kNumbers[] = {0.0, 1.0, -1.0, 0.015, 400.0, -32768.0, 1e-30, 1e30, -1e300};
  const auto number = [&] { return kNumbers[random.below(9)]; };
  depth::DepthModel model;
  model.format = static_cast<depth::SampleFormat>(random.below(8));
  model.geometry = static_cast<depth::Geometry>(random.below(5));
  model.intrinsics = {.width = random.below(24),
                      .height = random.below(24),
                      .fx = random.below(2) == 0 ? 30.0 : number(),
                      .fy = random.below(2) == 0 ? 30.0 : number(),
                      .cx = number(),
                      .cy = number()};
  model.row_stride_bytes = random.below(2) == 0 ? 0 : random.below(400);
  model.gray_row_stride_bytes = random.below(2) == 0 ? 0 : random.below(64);
  model.scale = {number(), number(), number()};
  model.offset = {number(), number(), number()};
  model.has_invalid_value = random.below(2) == 0;
  model.mm_per_unit = random.below(2) == 0 ? 1.0 : number();
  model.baseline_mm = number();
  model.has_gray = random.below(2) == 0;
  return model;
}

}  // namespace dseam::test
