// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/frame_fuser.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "../depth/count_lanes.hpp"
#include "box_lanes.hpp"

namespace dseam::cloud {
namespace {

using lanes::FloatLanes;
using lanes::IntLanes;
using lanes::kLanes;
using lanes::splat;

constexpr double kMostCounts = 65535.0;
constexpr std::uint32_t kAll = 0xFFU;

std::uint32_t count_of(std::uint32_t bits) noexcept {
  return static_cast<std::uint32_t>(std::popcount(bits));
}

std::uint32_t masked_bits(std::span<const std::uint8_t> row, std::uint32_t u,
                          std::uint32_t stride) noexcept {
  std::uint32_t set = 0;
  for (std::uint32_t i = 0; i < kLanes && u + i * stride < row.size(); ++i) {
    set |= (row[u + i * stride] != 0 ? 1U : 0U) << i;
  }
  return set;
}

// Further than `step` from both neighbours of a pair, one without depth counting as far.
IntLanes is_between(const IntLanes& counts, const IntLanes& one, const IntLanes& other,
                    const IntLanes& step) noexcept {
  const auto far = [&](const IntLanes& neighbour) noexcept {
    const IntLanes off = counts - neighbour;
    return (step < off) | (step < splat(0) - off) | (neighbour == splat(0));
  };
  return far(one) & far(other);
}

}  // namespace

/// What stays the same for all rows of a frame.
struct FrameFuser::Frame {
  const View& view;
  geometry::Transform3f T_base_camera;
  BoxLanes box;
  float mm_per_count;
  std::int32_t step_counts;  ///< 0: flying pixels are kept.
  std::uint32_t stride;
  ViewMask seen_by;

  [[nodiscard]] std::uint32_t flying_bits(std::uint32_t u, std::uint32_t v,
                                          const IntLanes& counts) const noexcept {
    const auto at = [&](int du, int dv) noexcept {
      return depth::counts_at(view.image, std::int64_t{u} + du, std::int64_t{v} + dv, stride);
    };
    const IntLanes step = splat(step_counts);
    return lanes::bits(is_between(counts, at(-1, 0), at(1, 0), step) |
                       is_between(counts, at(0, -1), at(0, 1), step));
  }
  /// Those of `present` that are to be fused, the others counted.
  [[nodiscard]] std::uint32_t usable_bits(std::uint32_t u, std::uint32_t v, const IntLanes& counts,
                                          std::uint32_t present, Report& report) const noexcept {
    std::uint32_t left = lanes::bits(splat(0) < counts) & present;
    report.without_depth += count_of(present & ~left);
    if (!view.masked.empty()) {
      const std::size_t width = view.image.intrinsics.width;
      const auto masked = masked_bits(view.masked.subspan(v * width, width), u, stride) & left;
      report.dropped_masked += count_of(masked);
      left &= ~masked;
    }
    if (step_counts > 0 && left != 0) {
      const std::uint32_t flying = flying_bits(u, v, counts) & left;
      report.dropped_flying += count_of(flying);
      left &= ~flying;
    }
    return left;
  }
};

Result<FrameFuser> FrameFuser::make(const Config& config, std::size_t max_width,
                                    Arena& arena) noexcept {
  const bool sensible = config.box.is_sensible() && config.max_step_mm >= 0.0F &&
                        std::isfinite(config.max_step_mm) && config.pixel_stride > 0;
  if (!sensible || max_width == 0) {
    return Errc::kInvalidArgument;
  }
  FrameFuser stage(config, arena.take<float>(max_width + kLanes));
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return stage;
}

void FrameFuser::set_box(const OrientedBox& box) noexcept {
  DSEAM_EXPECTS(box.is_sensible());
  config_.box = box;
}

FrameFuser::Report FrameFuser::run(const View& view, VoxelMap& map) noexcept {
  DSEAM_EXPECTS(view.number < kMaxViews);
  const depth::Intrinsics& k = view.image.intrinsics;
  Report report;
  const bool mask_fits = view.masked.empty() || view.masked.size() == view.image.depth.size();
  if (k.width + kLanes > ray_x_.size() || !depth::has_sensible_shape(view.image) || !mask_fits) {
    return report;
  }
  for (std::uint32_t i = 0; i * config_.pixel_stride < k.width; ++i) {
    ray_x_[i] = static_cast<float>((i * config_.pixel_stride - k.cx) / k.fx);
  }
  const double step = static_cast<double>(config_.max_step_mm) / view.image.mm_per_count;
  const Frame frame{view,
                    geometry::to_float(view.T_base_camera),
                    BoxLanes(config_.box),
                    static_cast<float>(view.image.mm_per_count),
                    step > 0.0 ? static_cast<std::int32_t>(std::min(step, kMostCounts)) : 0,
                    config_.pixel_stride,
                    static_cast<ViewMask>(1U << view.number)};
  for (std::uint32_t v = 0; v < k.height; v += config_.pixel_stride) {
    fuse_row(frame, v, map, report);
  }
  map.flush(frame.seen_by, report.map);
  return report;
}

void FrameFuser::fuse_row(const Frame& frame, std::uint32_t v, VoxelMap& map,
                          Report& report) const noexcept {
  const depth::DepthImage& image = frame.view.image;
  const geometry::Transform3f& t = frame.T_base_camera;
  const auto ray_y = static_cast<float>((v - image.intrinsics.cy) / image.intrinsics.fy);
  const std::uint32_t columns = (image.intrinsics.width + frame.stride - 1) / frame.stride;
  report.pixels += columns;
  // (rotation * ray) * z + translation; only the ray's x changes along a row.
  const geometry::Vec3f rest{t.row_x.y * ray_y + t.row_x.z, t.row_y.y * ray_y + t.row_y.z,
                             t.row_z.y * ray_y + t.row_z.z};
  for (std::uint32_t column = 0; column < columns; column += kLanes) {
    const std::uint32_t u = column * frame.stride;
    const std::uint32_t present = columns - column < kLanes ? (1U << (columns - column)) - 1 : kAll;
    const IntLanes counts = depth::counts_at(image, u, v, frame.stride);
    const std::uint32_t usable = frame.usable_bits(u, v, counts, present, report);
    if (usable == 0) {
      continue;
    }
    const FloatLanes z = lanes::to_float(counts) * splat(frame.mm_per_count);
    const FloatLanes ray_x = lanes::load(&ray_x_[column]);
    const auto base = [&](float slope, float offset, float shift_mm) noexcept {
      return (ray_x * splat(slope) + splat(offset)) * z + splat(shift_mm);
    };
    const FloatLanes px = base(t.row_x.x, rest.x, t.translation_mm.x);
    const FloatLanes py = base(t.row_y.x, rest.y, t.translation_mm.y);
    const FloatLanes pz = base(t.row_z.x, rest.z, t.translation_mm.z);
    const std::uint32_t inside = lanes::bits(frame.box.contains(px, py, pz)) & usable;
    report.dropped_outside += count_of(usable & ~inside);
    if (inside != 0) {
      map.insert_eight(px, py, pz, inside, frame.seen_by, report.map);
    }
  }
}

}  // namespace dseam::cloud
