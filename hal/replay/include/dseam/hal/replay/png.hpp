// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "dseam/hal/replay/loaded.hpp"

namespace dseam::hal::replay {

/// A gray image, row by row.
template <typename Sample>
struct GrayImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<Sample> pixels;
};

inline constexpr std::uint32_t kMaxImageSide = 16384;

/// Decodes a PNG file's bytes. Only gray with exactly the asked bits a sample is taken: another
/// kind of image is not depth.
///
/// Errors:  the fault alone, without the file's name.
[[nodiscard]] Loaded<GrayImage<std::uint16_t>> parse_png16(std::span<const std::byte> bytes);
[[nodiscard]] Loaded<GrayImage<std::uint8_t>> parse_png8(std::span<const std::byte> bytes);

/// Errors:  what could not be written, without the file's name.
[[nodiscard]] std::optional<LoadFault> write_png16(const std::filesystem::path& file,
                                                   std::uint32_t width, std::uint32_t height,
                                                   std::span<const std::uint16_t> pixels);
[[nodiscard]] std::optional<LoadFault> write_png8(const std::filesystem::path& file,
                                                  std::uint32_t width, std::uint32_t height,
                                                  std::span<const std::uint8_t> pixels);

}  // namespace dseam::hal::replay
