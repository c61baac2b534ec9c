// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace dseam::program {

using Rgb = std::array<std::uint8_t, 3>;

/// A picture, row by row from the top.
struct Image {
  Image(std::uint32_t width_px, std::uint32_t height_px, Rgb fill)
      : width(width_px), height(height_px), pixels(std::size_t{width_px} * height_px, fill) {}

  [[nodiscard]] Rgb& at(std::uint32_t u, std::uint32_t v) {
    return pixels[std::size_t{v} * width + u];
  }

  std::uint32_t width;
  std::uint32_t height;
  std::vector<Rgb> pixels;
};

/// The picture as `data:image/png;base64,...`, so that a page needs no second file.
[[nodiscard]] std::string png_data_uri(const Image& image);

}  // namespace dseam::program
