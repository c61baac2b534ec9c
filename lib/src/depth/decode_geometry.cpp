// SPDX-License-Identifier: Apache-2.0
#include "decode_geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dseam::depth {
namespace {

/// A height map that is read between its cells.
class HeightMap {
 public:
  HeightMap(const RawReader& in, const DepthModel& model) noexcept
      : in_(in),
        width_(model.intrinsics.width),
        height_(model.intrinsics.height),
        cell_x_mm_(model.scale[0] * model.mm_per_unit),
        cell_y_mm_(model.scale[1] * model.mm_per_unit),
        first_x_mm_(model.offset[0] * model.mm_per_unit),
        first_y_mm_(model.offset[1] * model.mm_per_unit) {}

  [[nodiscard]] double column_at(double x_mm) const noexcept {
    return (x_mm - first_x_mm_) / cell_x_mm_;
  }
  [[nodiscard]] double row_at(double y_mm) const noexcept {
    return (y_mm - first_y_mm_) / cell_y_mm_;
  }
  [[nodiscard]] bool inside(double column, double row) const noexcept {
    return column >= -0.5 && row >= -0.5 && column < width_ - 0.5 && row < height_ - 0.5;
  }
  [[nodiscard]] std::uint32_t nearest_column(double column) const noexcept {
    return static_cast<std::uint32_t>(std::clamp(column + 0.5, 0.0, width_ - 1.0));
  }
  [[nodiscard]] std::uint32_t nearest_row(double row) const noexcept {
    return static_cast<std::uint32_t>(std::clamp(row + 0.5, 0.0, height_ - 1.0));
  }

  /// Bilinear on a surface; the nearest cell beside a hole or an edge, which must not be blurred.
  [[nodiscard]] double z_at(double column, double row) const noexcept {
    constexpr double kEdgeMm = 1.0;
    if (std::isnan(column) || std::isnan(row)) {
      return column + row;
    }
    const double c = std::clamp(column, 0.0, width_ - 1.0);
    const double r = std::clamp(row, 0.0, height_ - 1.0);
    const auto c0 = static_cast<std::uint32_t>(c);
    const auto r0 = static_cast<std::uint32_t>(r);
    const std::uint32_t c1 = std::min(c0 + 1, width_ - 1);
    const std::uint32_t r1 = std::min(r0 + 1, height_ - 1);
    const std::array<double, 4> z{in_.z(c0, r0), in_.z(c1, r0), in_.z(c0, r1), in_.z(c1, r1)};
    const auto [least, most] = std::minmax_element(z.begin(), z.end());
    const bool all_given = std::none_of(z.begin(), z.end(), [](double v) { return std::isnan(v); });
    if (!all_given || *most - *least > kEdgeMm) {
      return in_.z(nearest_column(c), nearest_row(r));
    }
    const double across = c - c0;
    const double down = r - r0;
    const double upper = z[0] + (z[1] - z[0]) * across;
    const double lower = z[2] + (z[3] - z[2]) * across;
    return upper + (lower - upper) * down;
  }

 private:
  const RawReader& in_;
  std::uint32_t width_;
  std::uint32_t height_;
  double cell_x_mm_;
  double cell_y_mm_;
  double first_x_mm_;
  double first_y_mm_;
};

/// Where a ray meets the height map.
struct Meeting {
  double column = 0.0;
  double row = 0.0;
  double z_mm = 0.0;
  bool settled = false;
};

/// Looks up the height where the last height put the ray. It settles on any surface that the ray
/// meets under more than its own slope; at an edge it may not, and then there is no meeting.
Meeting follow(const HeightMap& map, double ray_x, double ray_y, double start_mm) noexcept {
  constexpr int kSteps = 8;
  constexpr double kSettledMm = 0.02;
  Meeting meeting{.z_mm = start_mm};
  for (int step = 0; step < kSteps && !meeting.settled; ++step) {
    meeting.column = map.column_at(ray_x * meeting.z_mm);
    meeting.row = map.row_at(ray_y * meeting.z_mm);
    const double z_mm = map.z_at(meeting.column, meeting.row);
    meeting.settled = std::isnan(z_mm) || std::abs(z_mm - meeting.z_mm) < kSettledMm;
    meeting.z_mm = z_mm;
  }
  return meeting;
}

}  // namespace

void Canvas::put(std::uint32_t column, std::uint32_t row, double z_mm, std::uint8_t gray) noexcept {
  const double count = z_mm * counts_per_mm_ + 0.5;
  if (!(count >= 1.0 && count < 65536.0)) {  // Written so that NaN is caught too.
    ++report_.out_of_range;
    return;
  }
  const auto rounded = static_cast<std::uint16_t>(count);
  std::uint16_t& pixel = out_.depth[std::size_t{row} * k_.width + column];
  if (pixel != 0) {
    ++report_.hidden;
    if (rounded >= pixel) {
      return;
    }
  } else {
    ++report_.valid;
  }
  pixel = rounded;
  put_gray(column, row, gray);
}

void Canvas::put_gray(std::uint32_t column, std::uint32_t row, std::uint8_t gray) noexcept {
  if (!out_.gray.empty()) {
    out_.gray[std::size_t{row} * k_.width + column] = gray;
  }
}

void decode_rays(const RawReader& in, const GrayReader& gray, const DepthModel& model,
                 Canvas& out) noexcept {
  const bool disparity = model.geometry == Geometry::kDisparity;
  const double depth_times_disparity = model.intrinsics.fx * model.baseline_mm;
  for (std::uint32_t row = 0; row < out.intrinsics().height; ++row) {
    for (std::uint32_t column = 0; column < out.intrinsics().width; ++column) {
      const double sample = in.z(column, row);
      const std::uint8_t shade = gray.at(column, row);
      out.put_gray(column, row, shade);
      if (std::isnan(sample)) {
        out.add_invalid();
      } else {
        out.put(column, row, disparity ? depth_times_disparity / sample : sample, shade);
      }
    }
  }
}

void decode_grid(const RawReader& in, const GrayReader& gray, const DepthModel& model,
                 double reference_depth_mm, Canvas& out) noexcept {
  const HeightMap map(in, model);
  const Intrinsics& k = out.intrinsics();
  for (std::uint32_t row = 0; row < k.height; ++row) {
    double start_mm = reference_depth_mm;
    for (std::uint32_t column = 0; column < k.width; ++column) {
      const double ray_x = (column - k.cx) / k.fx;
      const double ray_y = (row - k.cy) / k.fy;
      const Meeting at = follow(map, ray_x, ray_y, start_mm);
      if (!at.settled || std::isnan(at.z_mm)) {
        out.add_invalid();
      } else if (!map.inside(at.column, at.row)) {
        out.add_out_of_range();
      } else {
        start_mm = at.z_mm;
        out.put(column, row, at.z_mm,
                gray.at(map.nearest_column(at.column), map.nearest_row(at.row)));
      }
    }
  }
}

void decode_points(const RawReader& in, const GrayReader& gray, Canvas& out) noexcept {
  const Intrinsics& k = out.intrinsics();
  for (std::uint32_t row = 0; row < k.height; ++row) {
    for (std::uint32_t column = 0; column < k.width; ++column) {
      const double z_mm = in.z(column, row);
      const double u = k.fx * in.x(column, row) / z_mm + k.cx + 0.5;
      const double v = k.fy * in.y(column, row) / z_mm + k.cy + 0.5;
      if (std::isnan(z_mm) || in.at_origin(column, row)) {
        out.add_invalid();
      } else if (z_mm > 0.0 && u >= 0.0 && v >= 0.0 && u < k.width && v < k.height) {
        out.put(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v), z_mm,
                gray.at(column, row));
      } else {
        out.add_out_of_range();
      }
    }
  }
}

}  // namespace dseam::depth
