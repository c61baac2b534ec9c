// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "dseam/depth/depth_image.hpp"

namespace dseam::depth {

/// How the samples of one pixel are laid out. The names follow PFNC and V4L2.
enum class SampleFormat : std::uint8_t {
  kC16,           ///< Coord3D_C16, Z16, Y16, Mono16: one 16-bit sample, little endian.
  kC32f,          ///< Coord3D_C32f.
  kAC16,          ///< Coord3D_AC16: two samples, line scan.
  kAC16Planar,    ///< Coord3D_AC16_Planar: two planes.
  kABC16,         ///< Coord3D_ABC16: three samples a pixel.
  kABC16Planar,   ///< Coord3D_ABC16_Planar: three planes.
  kABC32f,        ///< Coord3D_ABC32f.
  kABC32fPlanar,  ///< Coord3D_ABC32f_Planar: three planes.
};

/// What the scaled sample means. SFNC: Scan3dOutputMode.
enum class Geometry : std::uint8_t {
  kProjected,   ///< Depth on the pixel's ray: z = sample, x and y from the intrinsics.
  kCalibrated,  ///< x, y, z are all given.
  kRectified,   ///< x and y on an even grid, z given.
  kDisparity,   ///< z = focal length * baseline / disparity.
  kLineScan,    ///< A profile a row: z, and x unless on an even grid; y is the transport.
};

/// A depth camera's data as read from the device at open, in the terms of SFNC, never of vendors.
///
/// Units:   value = raw * scale + offset, then times `mm_per_unit`; a disparity is in pixels.
///          An even grid has raw = column for x and raw = row for y.
/// Source:  GenICam SFNC 2.7, chapter 3D Scan Control.
struct DepthModel {
  SampleFormat format = SampleFormat::kC16;
  Geometry geometry = Geometry::kProjected;
  Intrinsics intrinsics;
  std::uint32_t row_stride_bytes = 0;       ///< 0: rows follow each other without padding.
  std::uint32_t gray_row_stride_bytes = 0;  ///< The same for the gray image.
  std::array<double, 3> scale{1.0, 1.0, 1.0};
  std::array<double, 3> offset{0.0, 0.0, 0.0};
  bool has_invalid_value = true;  ///< Tested on the raw sample, before scaling.
  double invalid_value = 0.0;
  double mm_per_unit = 1.0;
  double baseline_mm = 0.0;  ///< Disparity only.
  bool has_gray = false;     ///< Mono8 / GREY / Y8, registered to the depth.
};

}  // namespace dseam::depth
