// SPDX-License-Identifier: Apache-2.0
// Every Scan3dOutputMode that SFNC names, and what it means here.
#include <gtest/gtest.h>

#include <optional>

#include "dseam/hal/aravis/aravis_camera.hpp"
#include "hal/aravis/fake/faulty_aravis.hpp"

namespace dseam::hal::aravis {
namespace {

using test::FaultyAravis;

struct ModeRow {
  const char* mode;
  std::uint32_t pixel_format;
  std::optional<depth::Geometry> geometry;  ///< None: it does not say where its points lie.
};

constexpr ModeRow kRows[] = {
    {"UncalibratedC", ARV_PIXEL_FORMAT_COORD3D_C_16, std::nullopt},
    {"CalibratedABC_Grid", ARV_PIXEL_FORMAT_COORD3D_ABC_32F, depth::Geometry::kCalibrated},
    {"CalibratedABC_PointCloud", ARV_PIXEL_FORMAT_COORD3D_ABC_16, depth::Geometry::kCalibrated},
    {"CalibratedAC", ARV_PIXEL_FORMAT_COORD3D_AC_16, std::nullopt},
    {"CalibratedAC_Linescan", ARV_PIXEL_FORMAT_COORD3D_AC_16, depth::Geometry::kLineScan},
    {"CalibratedC", ARV_PIXEL_FORMAT_COORD3D_C_16, std::nullopt},
    {"CalibratedC_Linescan", ARV_PIXEL_FORMAT_COORD3D_C_16, std::nullopt},
    {"RectifiedC", ARV_PIXEL_FORMAT_COORD3D_C_16, depth::Geometry::kRectified},
    {"RectifiedC_Linescan", ARV_PIXEL_FORMAT_COORD3D_C_16, depth::Geometry::kLineScan},
    {"DisparityC_Linescan", ARV_PIXEL_FORMAT_COORD3D_C_16, std::nullopt},
    {"ProjectedC", ARV_PIXEL_FORMAT_COORD3D_C_16, depth::Geometry::kProjected}};

Result<std::unique_ptr<AravisCamera>> open(FaultyAravis& sys, std::string& problem) {
  AravisConfig config;
  config.id = FaultyAravis::kCameraId;
  config.pixel_format = "Depth";
  return AravisCamera::open(config, sys, problem);
}

class OutputMode : public ::testing::TestWithParam<ModeRow> {};

TEST_P(OutputMode, is_understood_as_sfnc_means_it_or_refused) {
  FaultyAravis sys({.width = 32,
                    .height = 24,
                    .pixel_format = GetParam().pixel_format,
                    .output_mode = GetParam().mode});
  std::string problem;

  const auto camera = open(sys, problem);

  ASSERT_EQ(camera.ok(), GetParam().geometry.has_value()) << problem;
  if (camera.ok()) {
    EXPECT_EQ(camera.value()->model().geometry, *GetParam().geometry);
  } else {
    EXPECT_EQ(camera.error(), Errc::kUnsupported);
    EXPECT_NE(problem.find("Scan3dOutputMode"), std::string::npos) << problem;
  }
}

INSTANTIATE_TEST_SUITE_P(Sfnc, OutputMode, ::testing::ValuesIn(kRows));

TEST(DistanceUnit, a_depth_in_pixels_is_refused) {
  FaultyAravis sys({.width = 32, .height = 24, .distance_unit = "Pixel"});
  std::string problem;

  EXPECT_EQ(open(sys, problem).error(), Errc::kUnsupported);
  EXPECT_NE(problem.find("Scan3dDistanceUnit"), std::string::npos) << problem;
}

}  // namespace
}  // namespace dseam::hal::aravis
