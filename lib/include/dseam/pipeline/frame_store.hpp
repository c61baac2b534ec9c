// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/depth/depth_image.hpp"

namespace dseam::pipeline {

/// Keeps the raw frames of a scan, 16-bit depth and 8-bit gray, until the last view is in.
///
/// Three bytes a pixel instead of twelve for a point: the points are made again when all poses are
/// adjusted, so keeping them would be keeping the same thing twice, and the worse of the two.
///
/// Memory:  `bytes()` from the arena at make().
/// Context: one thread.
class FrameStore {
 public:
  struct Capacity {
    std::size_t max_views = 6;
    std::size_t max_pixels = 1296U * 966U;  ///< Of one frame.
  };

  [[nodiscard]] static constexpr std::size_t bytes(const Capacity& capacity) noexcept {
    const std::size_t pixels = capacity.max_views * capacity.max_pixels;
    return Arena::bytes<std::uint16_t>(pixels) + Arena::bytes<std::uint8_t>(pixels);
  }
  /// Errors:  kInvalidArgument: more than cloud::kMaxViews views. kOutOfMemory: the arena.
  [[nodiscard]] static Result<FrameStore> make(const Capacity& capacity, Arena& arena) noexcept;

  /// Copies one frame.
  ///
  /// Errors:  kOutOfMemory: all places are taken, or it has more pixels than a place.
  ///          kBadData: spans, size or intrinsics contradict each other.
  Result<> add(const depth::DepthImage& frame) noexcept;
  void clear() noexcept { size_ = 0; }

  [[nodiscard]] std::span<const depth::DepthImage> frames() const noexcept {
    return std::span<const depth::DepthImage>(frames_).first(size_);
  }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool full() const noexcept { return size_ == capacity_.max_views; }

 private:
  FrameStore(const Capacity& capacity, Arena& arena) noexcept;

  Capacity capacity_;
  std::span<std::uint16_t> depth_;
  std::span<std::uint8_t> gray_;
  std::array<depth::DepthImage, cloud::kMaxViews> frames_{};
  std::size_t size_ = 0;
};

/// True where sizes, spans and intrinsics of a frame agree and a pixel has a ray.
[[nodiscard]] bool is_consistent(const depth::DepthImage& frame) noexcept;

}  // namespace dseam::pipeline
