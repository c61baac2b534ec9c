// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/crop_box.hpp"

#include <algorithm>
#include <bit>

#include "box_lanes.hpp"

namespace dseam::cloud {
namespace {

using lanes::kLanes;

struct EightPoints {
  lanes::FloatLanes x, y, z;
  std::uint32_t used;
};

EightPoints eight_at(const CloudView& cloud, std::size_t i) noexcept {
  const std::size_t count = std::min(kLanes, cloud.size() - i);
  if (count == kLanes) {
    return {lanes::load(&cloud.x[i]), lanes::load(&cloud.y[i]), lanes::load(&cloud.z[i]), 0xFFU};
  }
  float x[kLanes] = {};
  float y[kLanes] = {};
  float z[kLanes] = {};
  std::copy_n(&cloud.x[i], count, x);
  std::copy_n(&cloud.y[i], count, y);
  std::copy_n(&cloud.z[i], count, z);
  return {lanes::load(x), lanes::load(y), lanes::load(z), (1U << count) - 1U};
}

std::uint32_t count_of(std::uint32_t bits) noexcept {
  return static_cast<std::uint32_t>(std::popcount(bits));
}

}  // namespace

bool OrientedBox::is_sensible() const noexcept {
  const geometry::Transform3f& t = T_box_cloud;
  const float sum = geometry::squared_norm(t.row_x) + geometry::squared_norm(t.row_y) +
                    geometry::squared_norm(t.row_z) + geometry::squared_norm(t.translation_mm);
  return low_mm.x <= high_mm.x && low_mm.y <= high_mm.y && low_mm.z <= high_mm.z && sum < kEndless;
}

Result<CropBox> CropBox::make(const Config& config) noexcept {
  if (!config.box.is_sensible()) {
    return Errc::kInvalidArgument;
  }
  return CropBox(config);
}

CropBox::Report CropBox::run(const CloudView& cloud, Buffer<std::uint32_t>& kept) const noexcept {
  Report report;
  kept.clear();
  const BoxLanes box(config_.box);
  const std::span<std::uint32_t> room = kept.storage();
  for (std::size_t i = 0; i < cloud.size(); i += kLanes) {
    const EightPoints p = eight_at(cloud, i);
    const std::uint32_t finite = lanes::bits(are_finite(p.x, p.y, p.z)) & p.used;
    const std::uint32_t inside = lanes::bits(box.contains(p.x, p.y, p.z)) & finite;
    report.dropped_not_finite += count_of(p.used & ~finite);
    report.dropped_outside += count_of(finite & ~inside);
    for (std::uint32_t left = inside; left != 0; left &= left - 1) {
      if (report.kept == room.size()) {
        report.dropped_full += count_of(left);
        break;
      }
      room[report.kept++] =
          static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(std::countr_zero(left));
    }
  }
  kept.resize(report.kept);
  return report;
}

std::uint32_t copy_kept(const CloudView& cloud, std::span<const std::uint32_t> kept,
                        CloudBuffer& out) noexcept {
  const std::size_t count = std::min(kept.size(), out.capacity());
  for (std::size_t i = 0; i < count; ++i) {
    out.set(i, cloud[kept[i]]);
  }
  out.resize(count);
  return static_cast<std::uint32_t>(kept.size() - count);
}

}  // namespace dseam::cloud
