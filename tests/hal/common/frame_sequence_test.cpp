// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/camera/frame_sequence.hpp"

#include <gtest/gtest.h>

namespace dseam::hal {
namespace {

TEST(FrameSequence, numbers_that_follow_each_other_have_no_gap) {
  FrameSequence sequence(0, UINT32_MAX);

  const auto first = sequence.advance(17);
  const auto second = sequence.advance(18);

  EXPECT_EQ(first.gap, 0U);
  EXPECT_EQ(second.gap, 0U);
  EXPECT_EQ(second.sequence, first.sequence + 1);
}

TEST(FrameSequence, a_gige_vision_number_wraps_from_65535_to_1) {
  FrameSequence sequence(1, 65535);
  (void)sequence.advance(65534);

  EXPECT_EQ(sequence.advance(65535).gap, 0U);
  EXPECT_EQ(sequence.advance(1).gap, 0U);
  EXPECT_EQ(sequence.advance(4).gap, 2U);
}

TEST(FrameSequence, a_v4l2_number_wraps_at_32_bits) {
  FrameSequence sequence(0, UINT32_MAX);
  (void)sequence.advance(UINT32_MAX - 1);

  EXPECT_EQ(sequence.advance(1).gap, 2U);
}

TEST(FrameSequence, a_number_that_repeats_or_falls_back_is_a_frame_without_a_gap) {
  FrameSequence sequence(0, UINT32_MAX);
  const auto at = sequence.advance(100);

  EXPECT_EQ(sequence.advance(100).sequence, at.sequence + 1);
  EXPECT_EQ(sequence.advance(90).sequence, at.sequence + 2);
  EXPECT_EQ(sequence.advance(101).sequence, at.sequence + 3);
  EXPECT_EQ(sequence.advance(103).gap, 1U);
}

TEST(FrameSequence, a_number_far_behind_is_a_device_that_counts_anew) {
  FrameSequence sequence(0, UINT32_MAX);
  const auto at = sequence.advance(100'000);

  const auto anew = sequence.advance(0);

  EXPECT_EQ(anew.sequence, at.sequence + 1);
  EXPECT_EQ(anew.gap, 0U);
  EXPECT_EQ(sequence.advance(2).gap, 1U);
}

TEST(FrameSequence, after_a_reconnect_it_goes_on_without_a_gap) {
  FrameSequence sequence(1, 65535);
  const auto at = sequence.advance(1000);

  sequence.restart();

  EXPECT_EQ(sequence.advance(1).sequence, at.sequence + 1);
  EXPECT_EQ(sequence.advance(2).gap, 0U);
}

}  // namespace
}  // namespace dseam::hal
