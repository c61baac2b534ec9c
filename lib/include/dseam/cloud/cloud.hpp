// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/geometry/vec3f.hpp"

namespace dseam::cloud {

/// Points by reference, one array a coordinate, so that the hot loops vectorise.
///
/// Units:   mm; the frame is named by the variable: `cloud_base`, `cloud_camera`.
/// Shape:   three spans of one length.
struct CloudView {
  std::span<const float> x;
  std::span<const float> y;
  std::span<const float> z;

  [[nodiscard]] constexpr std::size_t size() const noexcept { return x.size(); }
  [[nodiscard]] constexpr geometry::Vec3f operator[](std::size_t i) const noexcept {
    return {x[i], y[i], z[i]};
  }
};

/// An appendable cloud over lent storage. It never grows: append() says so instead.
class CloudBuffer {
 public:
  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_points) noexcept {
    return 3 * Arena::bytes<float>(max_points);
  }
  CloudBuffer() = default;
  CloudBuffer(std::size_t max_points, Arena& arena) noexcept
      : x_(arena.take<float>(max_points)),
        y_(arena.take<float>(max_points)),
        z_(arena.take<float>(max_points)) {}
  constexpr CloudBuffer(std::span<float> x, std::span<float> y, std::span<float> z) noexcept
      : x_(x), y_(y), z_(z) {}

  constexpr void clear() noexcept { size_ = 0; }
  /// False, and nothing changed, when the buffer is full.
  [[nodiscard]] constexpr bool append(geometry::Vec3f p) noexcept {
    if (size_ == capacity()) {
      return false;
    }
    set(size_++, p);
    return true;
  }
  constexpr void set(std::size_t i, geometry::Vec3f p) noexcept {
    x_[i] = p.x;
    y_[i] = p.y;
    z_[i] = p.z;
  }
  /// Sets the size without touching the points; for code that writes through x(), y(), z().
  constexpr void resize(std::size_t size) noexcept {
    DSEAM_EXPECTS(size <= capacity());
    size_ = size;
  }

  [[nodiscard]] constexpr std::size_t size() const noexcept { return size_; }
  [[nodiscard]] constexpr std::size_t capacity() const noexcept { return z_.size(); }
  [[nodiscard]] constexpr geometry::Vec3f operator[](std::size_t i) const noexcept {
    return {x_[i], y_[i], z_[i]};
  }
  [[nodiscard]] constexpr std::span<float> x() const noexcept { return x_; }
  [[nodiscard]] constexpr std::span<float> y() const noexcept { return y_; }
  [[nodiscard]] constexpr std::span<float> z() const noexcept { return z_; }
  [[nodiscard]] constexpr CloudView view() const noexcept {
    return {x_.first(size_), y_.first(size_), z_.first(size_)};
  }

 private:
  std::span<float> x_;
  std::span<float> y_;
  std::span<float> z_;
  std::size_t size_ = 0;
};

/// One bit a view; the network holds at most this many views.
using ViewMask = std::uint16_t;
inline constexpr std::size_t kMaxViews = 16;

/// A cloud into which several views were fused: each point knows how often and by whom it was seen.
///
/// Shape:   `count` and `seen_by` have one entry a point, or are empty for a cloud from a file.
struct FusedCloudView {
  CloudView points;
  std::span<const std::uint32_t> count;
  std::span<const ViewMask> seen_by;
};

/// What normal estimation adds to a cloud, one entry a point.
///
/// Shape:   unit normals; (0, 0, 0) where the neighbourhood is degenerate, never a made-up one.
struct NormalsView {
  std::span<const float> nx;
  std::span<const float> ny;
  std::span<const float> nz;
  std::span<const float>
      variation;  ///< Smallest eigenvalue over the sum of all three, in [0, 1/3].
};

}  // namespace dseam::cloud
