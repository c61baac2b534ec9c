// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/frame_store.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "support/arena_owner.hpp"

namespace dseam::pipeline {
namespace {

constexpr FrameStore::Capacity kTwoSmallViews{.max_views = 2, .max_pixels = 12};

struct Frame {
  std::vector<std::uint16_t> depth = std::vector<std::uint16_t>(12, 6400);
  std::vector<std::uint8_t> gray = std::vector<std::uint8_t>(12, 80);
  depth::Intrinsics intrinsics{4, 3, 10.0, 10.0, 1.5, 1.0};

  [[nodiscard]] depth::DepthImage image() const { return {intrinsics, 1.0 / 64.0, depth, gray}; }
};

class FrameStoreTest : public ::testing::Test {
 protected:
  dseam::test::ArenaOwner memory_{FrameStore::bytes(kTwoSmallViews)};
  FrameStore store_ = FrameStore::make(kTwoSmallViews, memory_.arena()).value();
};

TEST_F(FrameStoreTest, a_kept_frame_is_a_copy) {
  Frame frame;
  ASSERT_TRUE(store_.add(frame.image()).ok());

  frame.depth[5] = 1;

  EXPECT_EQ(store_.frames()[0].count_at(1, 1), 6400);
  EXPECT_EQ(store_.frames()[0].gray_at(3, 2), 80);
}

TEST_F(FrameStoreTest, a_full_store_refuses_and_keeps_what_it_has) {
  EXPECT_TRUE(store_.add(Frame{}.image()).ok());
  EXPECT_TRUE(store_.add(Frame{}.image()).ok());

  EXPECT_EQ(store_.add(Frame{}.image()).error(), Errc::kOutOfMemory);

  EXPECT_EQ(store_.size(), 2U);
}

TEST_F(FrameStoreTest, a_frame_that_contradicts_itself_is_bad_data) {
  Frame truncated;
  truncated.depth.pop_back();
  Frame other_gray;
  other_gray.gray.pop_back();
  Frame no_focal_length;
  no_focal_length.intrinsics.fx = 0.0;
  Frame not_finite;
  not_finite.intrinsics.cy = std::numeric_limits<double>::quiet_NaN();

  for (const Frame& frame : {truncated, other_gray, no_focal_length, not_finite}) {
    EXPECT_EQ(store_.add(frame.image()).error(), Errc::kBadData);
  }
}

TEST_F(FrameStoreTest, a_frame_without_gray_is_kept_without_gray) {
  Frame frame;
  frame.gray.clear();

  ASSERT_TRUE(store_.add(frame.image()).ok());

  EXPECT_TRUE(store_.frames()[0].gray.empty());
}

TEST(FrameStore, too_little_memory_is_said_at_make) {
  dseam::test::ArenaOwner memory(FrameStore::bytes(kTwoSmallViews) - 64);

  EXPECT_EQ(FrameStore::make(kTwoSmallViews, memory.arena()).error(), Errc::kOutOfMemory);
}

}  // namespace
}  // namespace dseam::pipeline
