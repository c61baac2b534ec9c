// SPDX-License-Identifier: Apache-2.0
#include "picture/image.hpp"

#include <spng.h>

#include <cstdlib>
#include <memory>
#include <span>
#include <stdexcept>

namespace dseam::program {
namespace {

struct FreeContext {
  void operator()(spng_ctx* context) const noexcept { spng_ctx_free(context); }
};
struct FreeBytes {
  void operator()(void* bytes) const noexcept { std::free(bytes); }
};

void expect_ok(int error) {
  if (error != 0) {
    throw std::runtime_error(std::string("PNG encoder: ") + spng_strerror(error));
  }
}

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t given = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (k < given ? bytes[i + k] : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= given ? kDigits[group >> (18U - 6U * k) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace

std::string png_data_uri(const Image& image) {
  const std::unique_ptr<spng_ctx, FreeContext> context(spng_ctx_new(SPNG_CTX_ENCODER));
  expect_ok(spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1));
  spng_ihdr header = {};
  header.width = image.width;
  header.height = image.height;
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_TRUECOLOR;
  expect_ok(spng_set_ihdr(context.get(), &header));
  expect_ok(spng_encode_image(context.get(), image.pixels.data(), image.pixels.size() * sizeof(Rgb),
                              SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE));
  std::size_t size = 0;
  int error = 0;
  const std::unique_ptr<void, FreeBytes> bytes(spng_get_png_buffer(context.get(), &size, &error));
  expect_ok(error);
  return "data:image/png;base64," + base64({static_cast<const std::uint8_t*>(bytes.get()), size});
}

}  // namespace dseam::program
