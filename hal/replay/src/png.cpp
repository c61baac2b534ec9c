// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/replay/png.hpp"

#include <spng.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <string>

namespace dseam::hal::replay {
namespace {

struct Free {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using Context = std::unique_ptr<spng_ctx, Free>;
using File = std::unique_ptr<std::FILE, Free>;

constexpr std::size_t kMaxPixels = 64'000'000;

LoadFault fault(std::string text) { return {std::move(text)}; }

std::string size_text(const spng_ihdr& header) {
  return std::to_string(header.width) + " x " + std::to_string(header.height);
}

/// Empty when the header is that of an image we take.
std::string fault_in(const spng_ihdr& header, std::uint8_t bits) {
  if (header.color_type != SPNG_COLOR_TYPE_GRAYSCALE || header.bit_depth != bits) {
    return "is not a gray image of " + std::to_string(bits) + " bits";
  }
  const bool too_long = header.width > kMaxImageSide || header.height > kMaxImageSide;
  if (too_long || std::size_t{header.width} * header.height > kMaxPixels) {
    return "is too large: " + size_text(header) + " pixels";
  }
  return {};
}

/// The decoder takes a file for whole once it has its pixels; only the end mark shows that it is.
bool has_end_mark(std::span<const std::byte> bytes) {
  constexpr std::array<unsigned char, 12> kEnd{0,   0,   0,    0,    'I',  'E',
                                               'N', 'D', 0xAE, 0x42, 0x60, 0x82};
  return bytes.size() >= kEnd.size() &&
         std::ranges::equal(bytes.last(kEnd.size()), std::as_bytes(std::span(kEnd)));
}

template <typename Sample>
Loaded<GrayImage<Sample>> parse(std::span<const std::byte> bytes) {
  const Context context(spng_ctx_new(0));
  spng_set_image_limits(context.get(), kMaxImageSide, kMaxImageSide);
  spng_ihdr header{};
  int error = spng_set_png_buffer(context.get(), bytes.data(), bytes.size());
  error = error != 0 ? error : spng_get_ihdr(context.get(), &header);
  if (error != 0) {
    return fault(std::string("is not a PNG image: ") + spng_strerror(error));
  }
  if (std::string text = fault_in(header, 8 * sizeof(Sample)); !text.empty()) {
    return fault(std::move(text));
  }
  if (!has_end_mark(bytes)) {
    return fault("is damaged: it ends too early");
  }
  GrayImage<Sample> image{header.width, header.height, {}};
  image.pixels.resize(std::size_t{header.width} * header.height);
  error = spng_decode_image(context.get(), image.pixels.data(),
                            image.pixels.size() * sizeof(Sample), SPNG_FMT_PNG, 0);
  error = error != 0 ? error : spng_decode_chunks(context.get());
  if (error != 0) {
    return fault(std::string("is damaged: ") + spng_strerror(error));
  }
  return image;
}

template <typename Sample>
std::optional<LoadFault> write(const std::filesystem::path& path, std::uint32_t width,
                               std::uint32_t height, std::span<const Sample> pixels) {
  constexpr int kFast = 3;  // Depth noise hardly compresses: higher levels only take time.
  File file(std::fopen(path.c_str(), "wb"));
  if (file == nullptr) {
    return fault("cannot be written");
  }
  const Context context(spng_ctx_new(SPNG_CTX_ENCODER));
  spng_ihdr header{};
  header.width = width;
  header.height = height;
  header.bit_depth = 8 * sizeof(Sample);
  header.color_type = SPNG_COLOR_TYPE_GRAYSCALE;
  spng_set_png_file(context.get(), file.get());
  spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, kFast);
  int error = spng_set_ihdr(context.get(), &header);
  error = error != 0 ? error
                     : spng_encode_image(context.get(), pixels.data(), pixels.size_bytes(),
                                         SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  if (error != 0 || std::fclose(file.release()) != 0) {
    return fault(std::string("cannot be written: ") + spng_strerror(error));
  }
  return std::nullopt;
}

}  // namespace

Loaded<GrayImage<std::uint16_t>> parse_png16(std::span<const std::byte> bytes) {
  return parse<std::uint16_t>(bytes);
}

Loaded<GrayImage<std::uint8_t>> parse_png8(std::span<const std::byte> bytes) {
  return parse<std::uint8_t>(bytes);
}

std::optional<LoadFault> write_png16(const std::filesystem::path& file, std::uint32_t width,
                                     std::uint32_t height, std::span<const std::uint16_t> pixels) {
  return write(file, width, height, pixels);
}

std::optional<LoadFault> write_png8(const std::filesystem::path& file, std::uint32_t width,
                                    std::uint32_t height, std::span<const std::uint8_t> pixels) {
  return write(file, width, height, pixels);
}

}  // namespace dseam::hal::replay
