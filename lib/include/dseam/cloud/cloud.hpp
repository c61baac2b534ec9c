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

/// Whether a point has a normal, or why not.
enum class NormalState : std::uint8_t {
  kGood,
  kTooFew,     ///< Not enough neighbours.
  kCollinear,  ///< They lie on a line or in one place.
  kAmbiguous,  ///< They spread alike in two directions, so that no plane fits better than others.
};

/// What normal estimation adds to a cloud, one entry a point.
///
/// Shape:   unit normals; (0, 0, 0) where `state` is not kGood, never a made-up one.
struct NormalsView {
  std::span<const float> nx;
  std::span<const float> ny;
  std::span<const float> nz;
  std::span<const float>
      variation;  ///< Smallest eigenvalue over the sum of all three, in [0, 1/3].
  std::span<const NormalState> state{};  ///< May be empty.
};

/// Lent arrays for normals.
struct NormalsBuffer {
  std::span<float> nx;
  std::span<float> ny;
  std::span<float> nz;
  std::span<float> variation;
  std::span<NormalState> state;

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_points) noexcept {
    return 4 * Arena::bytes<float>(max_points) + Arena::bytes<NormalState>(max_points);
  }
  NormalsBuffer() = default;
  NormalsBuffer(std::size_t max_points, Arena& arena) noexcept
      : nx(arena.take<float>(max_points)),
        ny(arena.take<float>(max_points)),
        nz(arena.take<float>(max_points)),
        variation(arena.take<float>(max_points)),
        state(arena.take<NormalState>(max_points)) {}

  [[nodiscard]] std::size_t capacity() const noexcept { return state.size(); }
  void set(std::size_t i, geometry::Vec3f normal, float its_variation, NormalState its) noexcept {
    nx[i] = normal.x;
    ny[i] = normal.y;
    nz[i] = normal.z;
    variation[i] = its_variation;
    state[i] = its;
  }
  [[nodiscard]] geometry::Vec3f operator[](std::size_t i) const noexcept {
    return {nx[i], ny[i], nz[i]};
  }
  [[nodiscard]] NormalsView view(std::size_t size) const noexcept {
    return {nx.first(size), ny.first(size), nz.first(size), variation.first(size),
            state.first(size)};
  }
};

}  // namespace dseam::cloud
