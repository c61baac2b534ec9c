// SPDX-License-Identifier: Apache-2.0
// The detector on photographs that nobody made for it: 15 pictures of a 10 x 10 dot target.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "dot_grid.hpp"
#include "photographs.hpp"
#include "support/measured_data.hpp"

namespace dseam::markers {
namespace {

using Photographs = test::MeasuredData;

std::vector<Eigen::Vector2d> centres_of(const std::vector<Marker>& dots) {
  std::vector<Eigen::Vector2d> centres;
  for (const Marker& dot : dots) {
    centres.emplace_back(dot.u, dot.v);
  }
  return centres;
}

TEST_F(Photographs, dots_are_found_without_false_ones_to_a_quarter_of_a_pixel) {
  constexpr double kDots = 100.0 * test::kNumPhotographs;
  double on_grid = 0.0;
  double off_grid = 0.0;
  double squares = 0.0;
  for (int i = 0; i < test::kNumPhotographs; ++i) {
    const test::Photograph photo = test::load_photograph(i);
    ASSERT_FALSE(photo.gray.empty()) << "photograph " << i << " under " << test::data_dir();

    const std::vector<Eigen::Vector2d> found = centres_of(test::find_dots(photo));

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
