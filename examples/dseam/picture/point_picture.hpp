// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "dseam/cloud/cloud.hpp"
#include "picture/image.hpp"

namespace dseam::program {

/// Where a picture is taken from: parallel rays, so that lengths can be read off it.
///
/// Frame:   rows of `rotation` are right, down and away from the eye, in base.
struct Viewpoint {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d centre_base = Eigen::Vector3d::Zero();
  double px_per_mm = 3.0;
  std::uint32_t width = 640;
  std::uint32_t height = 480;

  /// Column, row, and depth in mm behind the centre.
  [[nodiscard]] Eigen::Vector3d project(const Eigen::Vector3d& p_base) const {
    const Eigen::Vector3d p = rotation * (p_base - centre_base) * px_per_mm;
    return {p.x() + 0.5 * width, p.y() + 0.5 * height, p.z() / px_per_mm};
  }
};

/// Looks at `centre_base` along `direction`; `up` is upwards in the picture.
[[nodiscard]] Viewpoint looking_along(const Eigen::Vector3d& direction, const Eigen::Vector3d& up);

/// A shaded picture of points, with the depths that say what hides what.
class PointPicture {
 public:
  /// `tint` has one index into `palette` for each point.
  PointPicture(const Viewpoint& viewpoint, const cloud::CloudView& cloud_base,
               const std::vector<std::uint8_t>& tint, const std::vector<Rgb>& palette,
               double point_radius_mm);

  [[nodiscard]] const Image& image() const { return image_; }
  [[nodiscard]] const Viewpoint& viewpoint() const { return viewpoint_; }
  /// Whether something lies more than `margin_mm` in front of the point.
  [[nodiscard]] bool hides(const Eigen::Vector3d& p_base, double margin_mm) const;

 private:
  void splat(const Eigen::Vector3d& p_px, double radius_px, std::uint8_t tint);
  [[nodiscard]] std::vector<float> smoothed_depth() const;
  [[nodiscard]] float lambert(const std::vector<float>& depth, int u, int v) const;
  /// Under 1 where something stands in front nearby: darkens creases and outlines.
  [[nodiscard]] float openness(const std::vector<float>& depth, int u, int v) const;
  void shade(const std::vector<float>& depth, const std::vector<Rgb>& palette);
  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * viewpoint_.width + static_cast<std::size_t>(u);
  }
  [[nodiscard]] bool inside(int u, int v) const {
    return u >= 0 && v >= 0 && u < static_cast<int>(viewpoint_.width) &&
           v < static_cast<int>(viewpoint_.height);
  }

  Viewpoint viewpoint_;
  Image image_;
  std::vector<float> depth_mm_;
  std::vector<std::uint8_t> tint_;
};

}  // namespace dseam::program
