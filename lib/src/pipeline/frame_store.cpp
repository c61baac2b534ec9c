// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/frame_store.hpp"

#include <algorithm>
#include <cmath>

namespace dseam::pipeline {

bool is_consistent(const depth::DepthImage& frame) noexcept {
  const depth::Intrinsics& k = frame.intrinsics;
  const std::size_t pixels = std::size_t{k.width} * k.height;
  const bool sizes = pixels > 0 && frame.depth.size() == pixels &&
                     (frame.gray.empty() || frame.gray.size() == pixels);
  const bool rays = std::isfinite(k.fx) && std::isfinite(k.fy) && std::isfinite(k.cx) &&
                    std::isfinite(k.cy) && k.fx > 0.0 && k.fy > 0.0;
  return sizes && rays && std::isfinite(frame.mm_per_count) && frame.mm_per_count > 0.0;
}

FrameStore::FrameStore(const Capacity& capacity, Arena& arena) noexcept
    : capacity_(capacity),
      depth_(arena.take<std::uint16_t>(capacity.max_views * capacity.max_pixels)),
      gray_(arena.take<std::uint8_t>(capacity.max_views * capacity.max_pixels)) {}

Result<FrameStore> FrameStore::make(const Capacity& capacity, Arena& arena) noexcept {
  if (capacity.max_views == 0 || capacity.max_views > cloud::kMaxViews) {
    return Errc::kInvalidArgument;
  }
  FrameStore store(capacity, arena);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return store;
}

Result<> FrameStore::add(const depth::DepthImage& frame) noexcept {
  if (!is_consistent(frame)) {
    return Errc::kBadData;
  }
  const std::size_t pixels = frame.depth.size();
  if (full() || pixels > capacity_.max_pixels) {
    return Errc::kOutOfMemory;
  }
  const std::size_t first = size_ * capacity_.max_pixels;
  const auto depth = depth_.subspan(first, pixels);
  const auto gray = gray_.subspan(first, frame.gray.size());
  std::copy(frame.depth.begin(), frame.depth.end(), depth.begin());
  std::copy(frame.gray.begin(), frame.gray.end(), gray.begin());
  frames_[size_++] = {frame.intrinsics, frame.mm_per_count, depth, gray};
  return {};
}

}  // namespace dseam::pipeline
