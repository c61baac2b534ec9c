// SPDX-License-Identifier: Apache-2.0
// What vendors state of their cameras, in SFNC's terms, against the z that follows from it.
#include <gtest/gtest.h>

#include <algorithm>

#include "raw_frame_builder.hpp"

namespace dseam::depth {
namespace {

using test::decode;
using test::Decoded;
using test::RawFrameBuilder;

/// A flat target: the same raw z in every pixel, and what it is in millimetres.
struct VendorRow {
  const char* camera;
  SampleFormat format;
  Geometry geometry;
  double scale_c;
  double offset_c;
  double mm_per_unit;
  double baseline_mm;
  double focal_px;
  double raw_c;
  double z_mm;
};

constexpr VendorRow kRows[] = {
    {"Basler blaze-101, Coord3D_C16: 10 m on 65535 counts", SampleFormat::kC16,
     Geometry::kProjected, 10000.0 / 65535.0, 0.0, 1.0, 0.0, 460.0, 2621.0, 399.9390},
    {"Basler blaze-101, Coord3D_ABC32f: millimetres", SampleFormat::kABC32f, Geometry::kCalibrated,
     1.0, 0.0, 1.0, 0.0, 460.0, 399.5, 399.5},
    {"Roboception rc_visard, DisparityC: sixteenths of a pixel", SampleFormat::kC16,
     Geometry::kDisparity, 0.0625, 0.0, 1.0, 160.0, 1082.0, 16 * 400.0, 432.8},
    {"Lucid Helios2, Coord3D_C16: quarters of a millimetre", SampleFormat::kC16,
     Geometry::kProjected, 0.25, 0.0, 1.0, 0.0, 540.0, 1600.0, 400.0},
    {"Lucid Helios2, Coord3D_ABC16", SampleFormat::kABC16, Geometry::kCalibrated, 0.25, 0.0, 1.0,
     0.0, 540.0, 1600.0, 400.0},
    {"SFNC, Coord3D_C32f in metres", SampleFormat::kC32f, Geometry::kProjected, 1.0, 0.0, 1000.0,
     0.0, 540.0, 0.4, 400.0},
    {"Micro-Epsilon surfaceCONTROL, Mono16: a grid with z scale and offset", SampleFormat::kC16,
     Geometry::kRectified, 0.002, 340.0, 1.0, 0.0, 0.0, 30000.0, 400.0},
    {"SICK Ranger3, CalibratedAC_Linescan", SampleFormat::kAC16, Geometry::kLineScan, 0.0125, 0.0,
     1.0, 0.0, 540.0, 32000.0, 400.0},
};

class VendorFigure : public ::testing::TestWithParam<VendorRow> {};

DepthModel model_of(const VendorRow& row) {
  DepthModel model;
  model.format = row.format;
  model.geometry = row.geometry;
  model.intrinsics = {
      .width = 9, .height = 7, .fx = row.focal_px, .fy = row.focal_px, .cx = 4.0, .cy = 3.0};
  model.scale = {0.25, 0.25, row.scale_c};
  model.offset[2] = row.offset_c;
  model.mm_per_unit = row.mm_per_unit;
  model.baseline_mm = row.baseline_mm;
  return model;
}

std::vector<std::byte> flat_target(const VendorRow& row, const DepthModel& model) {
  RawFrameBuilder raw(model);
  for (std::uint32_t v = 0; v < model.intrinsics.height; ++v) {
    for (std::uint32_t u = 0; u < model.intrinsics.width; ++u) {
      switch (layout_of(model.format).samples) {
        case 1:
          raw.set(u, v, {row.raw_c});
          break;
        case 2:
          raw.set(u, v, {4.0 * u, row.raw_c});
          break;
        default:
          raw.set(u, v, {0.0, 0.0, row.raw_c});
          break;
      }
    }
  }
  return {raw.bytes().begin(), raw.bytes().end()};
}

TEST_P(VendorFigure, becomes_the_millimetres_that_the_vendor_states) {
  const DepthModel model = model_of(GetParam());

  const Decoded out = decode(model, flat_target(GetParam(), model));

  ASSERT_GT(out.report.valid, 0U) << GetParam().camera;
  const double z_mm = *std::ranges::max_element(out.counts) * out.image.mm_per_count;
  EXPECT_NEAR(z_mm, GetParam().z_mm, 0.51 * out.image.mm_per_count) << GetParam().camera;
}

INSTANTIATE_TEST_SUITE_P(All, VendorFigure, ::testing::ValuesIn(kRows));

}  // namespace
}  // namespace dseam::depth
