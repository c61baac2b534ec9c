// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <png.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "dseam/markers/marker_finder.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/data_dir.hpp"

namespace dseam::test {

inline constexpr int kNumPhotographs = 15;

struct Photograph {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> gray;
};

inline std::filesystem::path photographs_dir() { return data_dir() / "circle_grid_handeye"; }

/// One of the photographs of the dot target; empty where it cannot be read.
inline Photograph load_photograph(int index) {
  const auto path = photographs_dir() / "images" / (std::to_string(index) + ".png");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  Photograph out;
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) {
    return out;
  }
  image.format = PNG_FORMAT_GRAY;
  out.width = image.width;
  out.height = image.height;
  out.gray.resize(PNG_IMAGE_SIZE(image));
  png_image_finish_read(&image, nullptr, out.gray.data(), 0, nullptr);
  return out;
}

/// What the marker finder finds in it, without a depth image beside it.
inline std::vector<markers::Marker> find_dots(const Photograph& photo) {
  ArenaOwner owner(markers::MarkerFinder::bytes(photo.width));
  auto finder = markers::MarkerFinder::make({}, photo.width, owner.arena());
  std::vector<markers::Marker> storage(1024);
  Buffer<markers::Marker> found(storage);
  depth::DepthImage frame;
  frame.intrinsics = {photo.width, photo.height, 550.0, 550.0, 320.0, 240.0};
  frame.gray = photo.gray;

  const AllocationCounter allocations;
  (void)finder.value().run(frame, found);
  EXPECT_EQ(allocations.count(), 0U);

  return {found.view().begin(), found.view().end()};
}

}  // namespace dseam::test
