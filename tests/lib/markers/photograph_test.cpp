// SPDX-License-Identifier: Apache-2.0
// The detector on photographs that nobody made for it: 15 pictures of a 10 x 10 dot target.
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <string>
#include <vector>

#include "dot_grid.hpp"
#include "dseam/markers/marker_finder.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/measured_data.hpp"

namespace dseam::markers {
namespace {

using Photographs = test::MeasuredData;

struct Photograph {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> gray;
};

Photograph load(int index) {
  const auto path =
      test::data_dir() / "circle_grid_handeye" / "images" / (std::to_string(index) + ".png");
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

std::vector<Eigen::Vector2d> find(const Photograph& photo) {
  test::ArenaOwner owner(MarkerFinder::bytes(photo.width));
  auto finder = MarkerFinder::make({}, photo.width, owner.arena());
  std::vector<Marker> storage(1024);
  Buffer<Marker> found(storage);
  depth::DepthImage frame;
  frame.intrinsics = {photo.width, photo.height, 550.0, 550.0, 320.0, 240.0};
  frame.gray = photo.gray;

  const test::AllocationCounter allocations;
  (void)finder.value().run(frame, found);
  EXPECT_EQ(allocations.count(), 0U);

  std::vector<Eigen::Vector2d> centres;
  for (const Marker& marker : found.view()) {
    centres.emplace_back(marker.u, marker.v);
  }
  return centres;
}

TEST_F(Photographs, dots_are_found_without_false_ones_to_a_quarter_of_a_pixel) {
  constexpr int kPhotographs = 15;
  constexpr double kDots = 100.0 * kPhotographs;
  double on_grid = 0.0;
  double off_grid = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kPhotographs; ++i) {
    const Photograph photo = load(i);
    ASSERT_FALSE(photo.gray.empty()) << "photograph " << i << " under " << test::data_dir();

    const std::vector<Eigen::Vector2d> found = find(photo);

    const test::DotGrid grid = test::GridGrower(found).largest();
    on_grid += static_cast<double>(grid.size());
    off_grid += static_cast<double>(found.size() - grid.size());
    squares += test::homography_squares(grid, found);
  }
  EXPECT_GE(on_grid / kDots, 0.98);
  EXPECT_LE(off_grid / (on_grid + off_grid), 0.01);
  EXPECT_LE(std::sqrt(squares / on_grid), 0.25);
  RecordProperty("found", std::to_string(on_grid / kDots));
  RecordProperty("false", std::to_string(off_grid / (on_grid + off_grid)));
  RecordProperty("homography_rms_px", std::to_string(std::sqrt(squares / on_grid)));
}

}  // namespace
}  // namespace dseam::markers
