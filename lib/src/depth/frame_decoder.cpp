// SPDX-License-Identifier: Apache-2.0
#include "dseam/depth/frame_decoder.hpp"

#include <algorithm>
#include <cmath>

#include "decode_geometry.hpp"
#include "dseam/base/expects.hpp"
#include "dseam/depth/sample_layout.hpp"
#include "raw_reader.hpp"

namespace dseam::depth {
namespace {

constexpr std::uint32_t kMaxSide = 16384;
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 26U;

bool positive(double value) noexcept { return std::isfinite(value) && value > 0.0; }

bool has_rays(const Intrinsics& k) noexcept {
  return positive(k.fx) && positive(k.fy) && std::isfinite(k.cx) && std::isfinite(k.cy);
}

bool on_grid(const DepthModel& model) noexcept {
  return model.geometry == Geometry::kRectified ||
         (model.geometry == Geometry::kLineScan && layout_of(model.format).samples == 1);
}

bool sizes_fit(const DepthModel& model) noexcept {
  const std::uint64_t width = model.intrinsics.width;
  const std::uint64_t height = model.intrinsics.height;
  const std::uint64_t tight = width * layout_of(model.format).pixel_bytes();
  const bool strides = (model.row_stride_bytes == 0 || model.row_stride_bytes >= tight) &&
                       (model.gray_row_stride_bytes == 0 || model.gray_row_stride_bytes >= width);
  return width > 0 && height > 0 && width <= kMaxSide && height <= kMaxSide &&
         width * height <= kMaxPixels && strides;
}

bool scales_fit(const DepthModel& model) noexcept {
  bool fit = positive(model.mm_per_unit) && model.scale[2] != 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    fit = fit && std::isfinite(model.scale[axis]) && std::isfinite(model.offset[axis]);
  }
  if (model.geometry == Geometry::kRectified || model.geometry == Geometry::kLineScan) {
    fit = fit && model.scale[0] != 0.0 && model.scale[1] != 0.0;
  }
  return fit;
}

bool rays_fit(const DepthModel& model) noexcept {
  if (model.geometry == Geometry::kRectified || model.geometry == Geometry::kLineScan) {
    return model.intrinsics.fx == 0.0 || has_rays(model.intrinsics);
  }
  return has_rays(model.intrinsics) &&
         (model.geometry != Geometry::kDisparity || positive(model.baseline_mm));
}

/// The device's own count where 16 bits of it reach far enough, so that decoding is a copy;
/// elsewhere the smallest count that does.
double choose_mm_per_count(const DepthModel& model, double max_depth_mm) noexcept {
  if (layout_of(model.format).is_float() || model.geometry == Geometry::kDisparity) {
    return max_depth_mm / 65536.0;
  }
  constexpr double kMaxCount = 65535.0;
  const double step_mm = std::abs(model.scale[2]) * model.mm_per_unit;
  const double farthest_mm =
      std::max(model.offset[2], model.offset[2] + kMaxCount * model.scale[2]) * model.mm_per_unit;
  const double reach_mm = std::min(max_depth_mm, farthest_mm);
  return kMaxCount * step_mm * (1.0 + 1e-9) >= reach_mm ? step_mm : farthest_mm / kMaxCount;
}

/// Where an axis of a grid begins, and how far apart its cells are, in mm.
struct GridAxis {
  double least_mm;
  double cell_mm;
};

GridAxis grid_axis(const DepthModel& model, Axis axis, std::uint32_t cells) noexcept {
  const auto i = static_cast<std::size_t>(axis);
  const bool sampled = axis == Axis::kX && layout_of(model.format).samples > 1;
  const double gaps = cells > 1 ? cells - 1.0 : 1.0;
  const double span = (sampled ? 65535.0 : gaps) * model.scale[i];
  return {std::min(model.offset[i], model.offset[i] + span) * model.mm_per_unit,
          std::abs(span) / gaps * model.mm_per_unit};
}

/// A pinhole for a grid that has none: at the reference depth one pixel covers one cell.
Intrinsics pinhole_of_grid(const DepthModel& model, double reference_mm) noexcept {
  const GridAxis x = grid_axis(model, Axis::kX, model.intrinsics.width);
  const GridAxis y = grid_axis(model, Axis::kY, model.intrinsics.height);
  Intrinsics k = model.intrinsics;
  k.fx = reference_mm / x.cell_mm;
  k.fy = reference_mm / y.cell_mm;
  k.cx = -x.least_mm / x.cell_mm;
  k.cy = -y.least_mm / y.cell_mm;
  return k;
}

bool geometry_fits_format(const DepthModel& model) noexcept {
  const std::uint8_t samples = layout_of(model.format).samples;
  const bool calibrated = model.geometry == Geometry::kCalibrated;
  return calibrated ? samples == 3 : samples != 2 || model.geometry == Geometry::kLineScan;
}

}  // namespace

Result<FrameDecoder> FrameDecoder::make(const DepthModel& model, const Config& config) noexcept {
  const bool config_fits = positive(config.max_depth_mm) && positive(config.reference_depth_mm);
  if (!config_fits || !sizes_fit(model) || !scales_fit(model) || !rays_fit(model)) {
    return Errc::kInvalidArgument;
  }
  if (!geometry_fits_format(model)) {
    return Errc::kUnsupported;
  }
  const FrameDecoder decoder(model, config);
  return positive(decoder.mm_per_count_) ? Result<FrameDecoder>(decoder) : Errc::kInvalidArgument;
}

FrameDecoder::FrameDecoder(const DepthModel& model, const Config& config) noexcept
    : model_(model),
      intrinsics_(has_rays(model.intrinsics) ? model.intrinsics
                                             : pinhole_of_grid(model, config.reference_depth_mm)),
      mm_per_count_(choose_mm_per_count(model, config.max_depth_mm)),
      reference_depth_mm_(config.reference_depth_mm) {}

FrameDecoder::Report FrameDecoder::run(const RawFrame& in, const ImageBuffers& out) const noexcept {
  DSEAM_EXPECTS(out.depth.size() >= pixels());
  DSEAM_EXPECTS(!model_.has_gray || out.gray.size() >= pixels());
  Report report;
  std::fill(out.depth.begin(), out.depth.end(), std::uint16_t{0});
  std::fill(out.gray.begin(), out.gray.end(), std::uint8_t{0});
  if (in.depth.size() < depth_bytes(model_)) {
    report.fault = Fault::kTruncated;
    return report;
  }
  const bool gray_fits = in.gray.size() >= gray_bytes(model_);
  report.fault = gray_fits ? Fault::kNone : Fault::kTruncatedGray;
  const RawReader reader(model_, in.depth);
  const GrayReader gray(model_, gray_fits ? in.gray : std::span<const std::byte>{});
  Canvas canvas(intrinsics_, mm_per_count_, out, report);
  if (on_grid(model_)) {
    decode_grid(reader, gray, model_, reference_depth_mm_, canvas);
  } else if (model_.geometry == Geometry::kCalibrated || model_.geometry == Geometry::kLineScan) {
    decode_points(reader, gray, canvas);
  } else {
    decode_rays(reader, gray, model_, canvas);
  }
  return report;
}

DepthImage FrameDecoder::image(const ImageBuffers& buffers) const noexcept {
  return {.intrinsics = intrinsics_,
          .mm_per_count = mm_per_count_,
          .depth = buffers.depth.first(pixels()),
          .gray = model_.has_gray ? buffers.gray.first(pixels()) : std::span<std::uint8_t>{}};
}

}  // namespace dseam::depth
