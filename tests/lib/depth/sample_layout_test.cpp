// SPDX-License-Identifier: Apache-2.0
#include "dseam/depth/sample_layout.hpp"

#include <gtest/gtest.h>

namespace dseam::depth {
namespace {

DepthModel frame_of(SampleFormat format) {
  return {.format = format, .intrinsics = {.width = 10, .height = 4}};
}

struct Row {
  std::uint32_t pfnc;
  SampleFormat format;
  std::uint64_t bytes;  // of 10 x 4 pixels
};

// PFNC: bits 16 to 23 of a code are the bits of a pixel, which the table must agree with.
class PfncFormat : public ::testing::TestWithParam<Row> {};

TEST_P(PfncFormat, is_known_with_the_size_that_its_code_states) {
  const auto format = format_from_pfnc(GetParam().pfnc);

  ASSERT_TRUE(format.ok());
  EXPECT_EQ(format.value(), GetParam().format);
  EXPECT_EQ(depth_bytes(frame_of(format.value())), GetParam().bytes);
  EXPECT_EQ(GetParam().bytes, 40U * ((GetParam().pfnc >> 16U) & 0xFFU) / 8U);
}

INSTANTIATE_TEST_SUITE_P(All, PfncFormat,
                         ::testing::Values(Row{0x011000B8, SampleFormat::kC16, 80},
                                           Row{0x01100007, SampleFormat::kC16, 80},
                                           Row{0x012000BF, SampleFormat::kC32f, 160},
                                           Row{0x022000BB, SampleFormat::kAC16, 160},
                                           Row{0x022000BC, SampleFormat::kAC16Planar, 160},
                                           Row{0x023000B9, SampleFormat::kABC16, 240},
                                           Row{0x023000BA, SampleFormat::kABC16Planar, 240},
                                           Row{0x026000C0, SampleFormat::kABC32f, 480},
                                           Row{0x026000C1, SampleFormat::kABC32fPlanar, 480}));

TEST(SampleLayout, formats_that_carry_no_16_bit_depth_are_refused) {
  EXPECT_EQ(format_from_pfnc(0x01080001).error(), Errc::kUnsupported);  // Mono8
  EXPECT_EQ(format_from_pfnc(0x010800B1).error(), Errc::kUnsupported);  // Coord3D_C8
  EXPECT_EQ(format_from_pfnc(0).error(), Errc::kUnsupported);
  EXPECT_EQ(format_from_fourcc(fourcc('Y', 'U', 'Y', 'V')).error(), Errc::kUnsupported);
  EXPECT_EQ(format_from_fourcc(fourcc('Y', '1', '6', ' ') | 1U << 31U).error(),
            Errc::kUnsupported);  // big endian
}

TEST(SampleLayout, z16_and_y16_are_one_sample_of_16_bits) {
  EXPECT_EQ(format_from_fourcc(fourcc('Z', '1', '6', ' ')).value(), SampleFormat::kC16);
  EXPECT_EQ(format_from_fourcc(fourcc('Y', '1', '6', ' ')).value(), SampleFormat::kC16);
}

TEST(SampleLayout, the_last_row_needs_no_padding_but_every_plane_does) {
  DepthModel model = frame_of(SampleFormat::kC16);
  model.row_stride_bytes = 32;
  EXPECT_EQ(depth_bytes(model), 3U * 32U + 20U);

  model.format = SampleFormat::kAC16Planar;
  EXPECT_EQ(depth_bytes(model), 7U * 32U + 20U);
}

TEST(SampleLayout, without_gray_no_gray_bytes_are_wanted) {
  DepthModel model = frame_of(SampleFormat::kC16);
  EXPECT_EQ(gray_bytes(model), 0U);

  model.has_gray = true;
  model.gray_row_stride_bytes = 16;
  EXPECT_EQ(gray_bytes(model), 3U * 16U + 10U);
}

}  // namespace
}  // namespace dseam::depth
