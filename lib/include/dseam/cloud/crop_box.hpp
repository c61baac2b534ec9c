// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/geometry/transform3f.hpp"

namespace dseam::cloud {

/// A box in a frame of its own; its faces belong to it.
///
/// Frame:   `T_box_cloud` takes the cloud's coordinates to the box's; the identity at first.
struct OrientedBox {
  geometry::Vec3f low_mm{-kEndless, -kEndless, -kEndless};
  geometry::Vec3f high_mm{kEndless, kEndless, kEndless};
  geometry::Transform3f T_box_cloud;

  static constexpr float kEndless = std::numeric_limits<float>::max();

  [[nodiscard]] bool is_aligned() const noexcept { return T_box_cloud == geometry::Transform3f{}; }
  /// No NaN in it, and on no axis its low end above its high end.
  [[nodiscard]] bool is_sensible() const noexcept;
};

/// Keeps the points inside a box: the paper's passthrough filter, in any frame.
///
/// Time:    O(points). Context: real-time safe.
class CropBox {
 public:
  struct Config {
    OrientedBox box;
  };
  struct Report {
    std::uint32_t kept = 0;
    std::uint32_t dropped_outside = 0;
    std::uint32_t dropped_not_finite = 0;
    std::uint32_t dropped_full = 0;  ///< Inside, but `kept` was full.
  };

  /// kInvalidArgument: a box that is not sensible.
  [[nodiscard]] static Result<CropBox> make(const Config& config) noexcept;

  /// The indices of what is inside, rising.
  Report run(const CloudView& cloud, Buffer<std::uint32_t>& kept) const noexcept;

 private:
  explicit CropBox(const Config& config) noexcept : config_(config) {}
  Config config_;
};

/// Copies the points whose indices were kept; as many as `out` has room for. `out` may be the
/// storage of `cloud` itself when the indices rise. Returns how many found no room.
std::uint32_t copy_kept(const CloudView& cloud, std::span<const std::uint32_t> kept,
                        CloudBuffer& out) noexcept;

}  // namespace dseam::cloud
