// SPDX-License-Identifier: Apache-2.0
#include "dseam/depth/frame_decoder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/depth/sample_layout.hpp"
#include "raw_frame_builder.hpp"
#include "support/allocation_counter.hpp"

namespace dseam::depth {
namespace {

using test::decode;
using test::Decoded;
using test::RawFrameBuilder;
using Fault = FrameDecoder::Fault;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

DepthModel projected() {
  return {.intrinsics = {.width = 4, .height = 3, .fx = 5.0, .fy = 5.0, .cx = 1.5, .cy = 1.0},
          .scale = {1.0, 1.0, 0.25}};
}

TEST(FrameDecoder, a_16_bit_projected_depth_is_copied_count_by_count) {
  RawFrameBuilder raw(projected());
  raw.set(0, 0, {1600}).set(3, 2, {65535}).set(1, 1, {0});

  const Decoded out = decode(projected(), raw.bytes());

  EXPECT_DOUBLE_EQ(out.image.mm_per_count, 0.25);
  EXPECT_EQ(out.image.count_at(0, 0), 1600);
  EXPECT_EQ(out.image.count_at(3, 2), 65535);
  EXPECT_EQ(out.image.count_at(1, 1), 0);
  EXPECT_EQ(out.report.valid, 2U);
  EXPECT_EQ(out.report.invalid, 10U);
}

TEST(FrameDecoder, the_invalid_value_is_tested_before_scale_and_offset) {
  DepthModel model = projected();
  model.offset[2] = 100.0;
  model.invalid_value = 65535.0;
  RawFrameBuilder raw(model);
  raw.fill({65535}).set(2, 1, {800}).set(3, 1, {0});

  const Decoded out = decode(model, raw.bytes());

  EXPECT_NEAR(out.z_mm(2, 1), 300.0, out.image.mm_per_count);
  EXPECT_NEAR(out.z_mm(3, 1), 100.0, out.image.mm_per_count);
  EXPECT_EQ(out.report.valid, 2U);
}

TEST(FrameDecoder, a_row_stride_with_padding_is_skipped) {
  DepthModel model = projected();
  model.row_stride_bytes = 12;
  RawFrameBuilder raw(model);
  raw.set(3, 2, {400}).set(0, 1, {444});

  const Decoded out = decode(model, raw.bytes());

  EXPECT_DOUBLE_EQ(out.z_mm(3, 2), 100.0);
  EXPECT_DOUBLE_EQ(out.z_mm(0, 1), 111.0);
  EXPECT_EQ(out.report.valid, 2U);
}

TEST(FrameDecoder, a_device_in_metres_gives_millimetres) {
  DepthModel model = projected();
  model.format = SampleFormat::kC32f;
  model.scale[2] = 1.0;
  model.mm_per_unit = 1000.0;
  RawFrameBuilder raw(model);
  raw.fill({kNan}).set(1, 1, {0.4375});

  const Decoded out = decode(model, raw.bytes());

  EXPECT_NEAR(out.z_mm(1, 1), 437.5, 0.5 * out.image.mm_per_count);
  EXPECT_EQ(out.report.invalid, 11U);
}

TEST(FrameDecoder, a_disparity_is_focal_length_times_baseline_over_disparity) {
  DepthModel model = projected();
  model.geometry = Geometry::kDisparity;
  model.scale[2] = 0.0625;
  model.intrinsics.fx = model.intrinsics.fy = 1082.0;
  model.baseline_mm = 160.0;
  RawFrameBuilder raw(model);
  raw.set(0, 0, {16 * 400});

  const Decoded out = decode(model, raw.bytes());

  EXPECT_NEAR(out.z_mm(0, 0), 1082.0 * 160.0 / 400.0, 0.5 * out.image.mm_per_count);
}

class CalibratedFormat : public ::testing::TestWithParam<SampleFormat> {};

TEST_P(CalibratedFormat, points_go_to_the_pixels_they_project_into) {
  DepthModel model = projected();
  model.format = GetParam();
  model.geometry = Geometry::kCalibrated;
  model.scale = {0.25, 0.25, 0.25};
  model.offset = {-8192.0, -8192.0, 0.0};
  const Intrinsics& k = model.intrinsics;
  RawFrameBuilder raw(model);
  for (std::uint32_t v = 0; v < k.height; ++v) {
    for (std::uint32_t u = 0; u < k.width; ++u) {
      const double z = 400.0 + 8.0 * u;
      raw.set(u, v,
              {32768.0 + 4 * z * (u - k.cx) / k.fx, 32768.0 + 4 * z * (v - k.cy) / k.fy, 4 * z});
    }
  }

  const Decoded out = decode(model, raw.bytes());

  EXPECT_EQ(out.report.valid, 12U);
  EXPECT_NEAR(out.z_mm(2, 1), 416.0, out.image.mm_per_count);
  EXPECT_NEAR(out.z_mm(0, 2), 400.0, out.image.mm_per_count);
}

INSTANTIATE_TEST_SUITE_P(All, CalibratedFormat,
                         ::testing::Values(SampleFormat::kABC16, SampleFormat::kABC16Planar,
                                           SampleFormat::kABC32f, SampleFormat::kABC32fPlanar));

TEST(FrameDecoder, of_two_points_in_one_pixel_the_nearer_wins_whatever_their_order) {
  DepthModel model = projected();
  model.format = SampleFormat::kABC32f;
  model.geometry = Geometry::kCalibrated;
  model.scale = {1.0, 1.0, 1.0};
  RawFrameBuilder raw(model);
  raw.set(0, 0, {50, 0, 500}).set(1, 0, {40, 0, 400}).set(2, 0, {45, 0, 450});

  const Decoded out = decode(model, raw.bytes());

  EXPECT_NEAR(out.z_mm(2, 1), 400.0, out.image.mm_per_count);
  EXPECT_EQ(out.report.valid, 1U);
  EXPECT_EQ(out.report.hidden, 2U);
  EXPECT_EQ(out.report.invalid, 9U);
}

DepthModel height_map() {
  return {.geometry = Geometry::kRectified,
          .intrinsics = {.width = 64, .height = 48},
          .scale = {0.5, 0.5, 0.01},
          .offset = {-16.0, -12.0, 0.0}};
}

/// z of the plane z = 400 + 0.3 x - 0.2 y seen along the ray of a pixel.
double tilted_plane_mm(const Intrinsics& k, double u, double v) {
  return 400.0 / (1.0 - 0.3 * (u - k.cx) / k.fx + 0.2 * (v - k.cy) / k.fy);
}

TEST(FrameDecoder, an_even_grid_is_seen_along_the_rays_of_a_pinhole) {
  const DepthModel model = height_map();
  RawFrameBuilder raw(model);
  for (std::uint32_t row = 0; row < 48; ++row) {
    for (std::uint32_t column = 0; column < 64; ++column) {
      raw.set(column, row, {100.0 * (400.0 + 0.3 * (0.5 * column - 16) - 0.2 * (0.5 * row - 12))});
    }
  }

  const Decoded out = decode(model, raw.bytes());

  for (std::uint32_t v = 2; v < 46; ++v) {
    for (std::uint32_t u = 2; u < 62; ++u) {
      ASSERT_NEAR(out.z_mm(u, v), tilted_plane_mm(out.image.intrinsics, u, v), 0.02);
    }
  }
}

TEST(FrameDecoder, a_line_scan_takes_y_from_the_row) {
  DepthModel model = height_map();
  model.format = SampleFormat::kAC16;
  model.geometry = Geometry::kLineScan;
  model.intrinsics.fx = model.intrinsics.fy = 800.0;
  model.intrinsics.cx = 31.5;
  model.intrinsics.cy = 23.5;
  model.scale[0] = 0.001;
  RawFrameBuilder raw(model);
  raw.set(7, 40, {26'000, 40'000});

  const Decoded out = decode(model, raw.bytes());

  // x = 10 mm, y = 0.5 * 40 - 12 = 8 mm, z = 400 mm: u = 51.5, v = 39.5.
  EXPECT_NEAR(out.z_mm(52, 40), 400.0, 0.01);
  EXPECT_EQ(out.report.valid, 1U);
}

TEST(FrameDecoder, gray_moves_with_its_point_and_is_kept_where_depth_is_missing) {
  DepthModel model = projected();
  model.has_gray = true;
  RawFrameBuilder raw(model);
  raw.set(1, 1, {400});
  std::vector<std::byte> gray(12, std::byte{7});
  gray[5] = std::byte{200};

  const Decoded out = decode(model, raw.bytes(), gray);

  EXPECT_EQ(out.image.gray_at(1, 1), 200);
  EXPECT_EQ(out.image.gray_at(0, 0), 7);
}

TEST(FrameDecoder, a_short_payload_is_named_and_decodes_to_nothing) {
  DepthModel model = projected();
  model.has_gray = true;
  RawFrameBuilder raw(model);
  raw.fill({400});
  const std::vector<std::byte> gray(12, std::byte{7});

  const Decoded short_depth = decode(model, raw.bytes().first(23), gray);
  const Decoded short_gray = decode(model, raw.bytes(), std::span(gray).first(11));

  EXPECT_EQ(short_depth.report.fault, Fault::kTruncated);
  EXPECT_EQ(short_depth.report.valid, 0U);
  EXPECT_EQ(short_gray.report.fault, Fault::kTruncatedGray);
  EXPECT_EQ(short_gray.report.valid, 12U);
  EXPECT_EQ(short_gray.image.gray_at(1, 1), 0);
}

TEST(FrameDecoder, depths_beyond_16_bits_behind_the_camera_or_infinite_are_counted) {
  DepthModel model = projected();
  model.format = SampleFormat::kC32f;
  model.scale[2] = 1.0;
  RawFrameBuilder raw(model);
  raw.fill({kNan}).set(0, 0, {-5}).set(1, 0, {1e30}).set(2, 0, {kInfinity}).set(3, 0, {-kInfinity});

  const Decoded out = decode(model, raw.bytes());

  EXPECT_EQ(out.report.out_of_range, 4U);
  EXPECT_EQ(out.report.valid, 0U);
}

TEST(FrameDecoder, every_model_that_is_accepted_survives_random_bytes) {
  Pcg32 random(3);
  for (int trial = 0; trial < 3000; ++trial) {
    DepthModel model = test::random_model(random);
    std::vector<std::byte> depth(random.below(4096));
    std::vector<std::byte> gray(random.below(1024));
    for (std::byte& b : depth) b = std::byte(random.below(256));

    const auto decoder = FrameDecoder::make(model);
    if (!decoder.ok()) {
      continue;
    }
    std::vector<std::uint16_t> counts(decoder.value().pixels());
    std::vector<std::uint8_t> shades(decoder.value().pixels());
    const auto report = decoder.value().run({depth, gray}, {counts, shades});

    const std::uint32_t seen = report.valid + report.invalid + report.out_of_range + report.hidden;
    ASSERT_EQ(seen, report.fault == Fault::kTruncated ? 0U : counts.size());
  }
}

TEST(FrameDecoder, run_allocates_nothing) {
  const DepthModel model = height_map();
  const auto decoder = FrameDecoder::make(model).value();
  RawFrameBuilder raw(model);
  raw.fill({40'000});
  std::vector<std::uint16_t> counts(decoder.pixels());

  const test::AllocationCounter allocations;
  (void)decoder.run({raw.bytes(), {}}, {counts, {}});

  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace dseam::depth
