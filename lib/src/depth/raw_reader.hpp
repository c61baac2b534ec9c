// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include "dseam/depth/depth_model.hpp"
#include "dseam/depth/sample_layout.hpp"

namespace dseam::depth {

enum class Axis : std::uint8_t { kX, kY, kZ };

/// The coordinates of a raw frame in mm; NaN where the device gives none.
class RawReader {
 public:
  /// `bytes` holds at least depth_bytes(model).
  RawReader(const DepthModel& model, std::span<const std::byte> bytes) noexcept
      : model_(model), layout_(layout_of(model.format)), bytes_(bytes.data()) {
    const std::uint64_t row = row_bytes(model);
    row_step_ = static_cast<std::size_t>(row);
    pixel_step_ = layout_.pixel_bytes();
    sample_step_ = layout_.planar ? row_step_ * model.intrinsics.height : layout_.sample_bytes;
  }

  /// The scaled z sample: mm, or pixels when it is a disparity.
  [[nodiscard]] double z(std::uint32_t column, std::uint32_t row) const noexcept {
    const double sample = raw(column, row, layout_.samples - 1U);
    const bool marked = model_.has_invalid_value && sample == model_.invalid_value;
    return marked ? std::numeric_limits<double>::quiet_NaN() : scaled(sample, Axis::kZ);
  }
  [[nodiscard]] double x(std::uint32_t column, std::uint32_t row) const noexcept {
    return scaled(layout_.samples > 1 ? raw(column, row, 0) : column, Axis::kX);
  }
  [[nodiscard]] double y(std::uint32_t column, std::uint32_t row) const noexcept {
    return scaled(layout_.samples > 2 ? raw(column, row, 1) : row, Axis::kY);
  }
  /// True where a float format says "no point" by the origin itself.
  [[nodiscard]] bool at_origin(std::uint32_t column, std::uint32_t row) const noexcept {
    return layout_.is_float() && layout_.samples == 3 && raw(column, row, 0) == 0.0 &&
           raw(column, row, 1) == 0.0 && raw(column, row, 2) == 0.0;
  }

 private:
  [[nodiscard]] double raw(std::uint32_t column, std::uint32_t row,
                           std::uint32_t sample) const noexcept {
    const std::byte* place =
        bytes_ + row * row_step_ + column * pixel_step_ + sample * sample_step_;
    if (layout_.is_float()) {
      float value = 0.0F;
      std::memcpy(&value, place, sizeof value);
      return static_cast<double>(value);
    }
    // Little endian by definition, whatever this processor is.
    return static_cast<double>(std::to_integer<std::uint32_t>(place[0]) |
                               std::to_integer<std::uint32_t>(place[1]) << 8U);
  }
  [[nodiscard]] double scaled(double sample, Axis axis) const noexcept {
    const auto i = static_cast<std::size_t>(axis);
    return (sample * model_.scale[i] + model_.offset[i]) * model_.mm_per_unit;
  }

  const DepthModel& model_;
  SampleLayout layout_;
  const std::byte* bytes_;
  std::size_t row_step_ = 0;
  std::size_t pixel_step_ = 0;
  std::size_t sample_step_ = 0;
};

}  // namespace dseam::depth
