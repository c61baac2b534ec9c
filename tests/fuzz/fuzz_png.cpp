// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdlib>

#include "dseam/hal/replay/png.hpp"

namespace {

template <typename Image>
void check(const dseam::hal::replay::Loaded<Image>& image) {
  if (image.ok() &&
      image.value().pixels.size() != std::size_t{image.value().width} * image.value().height) {
    std::abort();
  }
}

}  // namespace

/// No input is read out of bounds, and what is accepted has all its pixels.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  check(dseam::hal::replay::parse_png16(bytes));
  check(dseam::hal::replay::parse_png8(bytes));
  return 0;
}
