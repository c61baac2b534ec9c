// SPDX-License-Identifier: Apache-2.0
#include "dseam/markers/marker_finder.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "markers/rim/ellipse_edge.hpp"
#include "markers/surface/disc_surface.hpp"

namespace dseam::markers {
namespace {

// The ellipse with the blob's second moments.
geometry::Ellipse moment_ellipse(const Blob& blob) noexcept {
  const double n = blob.area_px;
  const double u = static_cast<double>(blob.sum_u) / n;
  const double v = static_cast<double>(blob.sum_v) / n;
  const double uu = static_cast<double>(blob.sum_uu) / n - u * u;
  const double vv = static_cast<double>(blob.sum_vv) / n - v * v;
  const double uv = static_cast<double>(blob.sum_uv) / n - u * v;
  const double mean = (uu + vv) / 2.0;
  const double spread = std::hypot((uu - vv) / 2.0, uv);
  return {u, v, 2.0 * std::sqrt(mean + spread), 2.0 * std::sqrt(std::max(mean - spread, 1e-6)),
          0.5 * std::atan2(2.0 * uv, uu - vv)};
}

bool worth_a_look(const Blob& blob, const MarkerFinder::Config& c, std::uint32_t width) noexcept {
  constexpr double kMinShareOfArea = 0.5;  // A thresholded disc is smaller than the real one.
  const double max_radius_px = width / 16.0;
  const double area = blob.area_px;
  return area > kMinShareOfArea * std::numbers::pi * c.min_half_axis_px * c.min_half_axis_px &&
         area < std::numbers::pi * max_radius_px * max_radius_px && blob.max_u > blob.min_u + 2U &&
         blob.max_v > blob.min_v + 2U;
}

bool ellipse_like(const Blob& blob, const geometry::Ellipse& e,
                  const MarkerFinder::Config& c) noexcept {
  const double fill = blob.area_px / (std::numbers::pi * e.a * e.b);
  return e.b >= 0.8 * c.min_axis_ratio * e.a && std::abs(fill - 1.0) < c.max_fill_error;
}

bool edge_is_a_rim(const EllipseEdge& edge, const MarkerFinder::Config& c) noexcept {
  const double max_width = std::max(c.max_edge_width_px, 0.2 * edge.ellipse.b);
  return edge.converged && edge.rim_seen >= c.min_rim_seen &&
         edge.rms_px <= c.max_edge_rms_of_radius * edge.ellipse.b &&
         edge.edge_width_px <= max_width && edge.contrast >= c.min_contrast &&
         edge.unevenness <= c.max_unevenness && edge.flatness < c.max_unevenness &&
         edge.ellipse.b >= c.min_axis_ratio * edge.ellipse.a &&
         edge.ellipse.b >= c.min_half_axis_px;
}

constexpr double kFloorPx = 0.01;  // What sampling and lens leave, whatever the noise.

void set_space(const depth::DepthImage& frame, const SurfaceDisc& disc, double sigma_depth_mm,
               Marker& m) noexcept {
  const depth::Intrinsics& k = frame.intrinsics;
  m.has_depth = true;
  m.p_camera = disc.centre;
  m.radius_mm = disc.radius_mm;
  const double px_per_mm = k.fx / disc.centre.z() * std::sqrt(m.ellipse.b / m.ellipse.a);
  m.sigma_px = std::hypot(kFloorPx, disc.sigma_mm * px_per_mm);
  m.u = k.fx * disc.centre.x() / disc.centre.z() + k.cx;
  m.v = k.fy * disc.centre.y() / disc.centre.z() + k.cy;
  // A pixel's error slides the point along the surface, an error of depth along the ray.
  const Eigen::Vector3d ray = disc.centre / disc.centre.z();
  Eigen::Matrix<double, 3, 2> slide;
  slide.col(0) = Eigen::Vector3d(disc.centre.z() / k.fx, 0.0, 0.0);
  slide.col(1) = Eigen::Vector3d(0.0, disc.centre.z() / k.fy, 0.0);
  const double towards = disc.normal.dot(ray);
  const Eigen::Matrix3d along =
      Eigen::Matrix3d::Identity() - ray * disc.normal.transpose() / towards;
  const Eigen::Matrix<double, 3, 2> j = along * slide;
  m.covariance_mm2 = m.sigma_px * m.sigma_px * j * j.transpose() +
                     sigma_depth_mm * sigma_depth_mm * ray * ray.transpose();
}

}  // namespace

Result<MarkerFinder> MarkerFinder::make(const Config& config, std::uint32_t width,
                                        Arena& arena) noexcept {
  const bool sizes_ok = config.min_radius_mm > 0.0 && config.max_radius_mm > config.min_radius_mm &&
                        config.min_half_axis_px >= 1.5;
  if (!sizes_ok || !(config.sigma_depth_mm > 0.0)) {
    return Errc::kInvalidArgument;
  }
  const Result<BlobFinder> blobs = BlobFinder::make(config.blobs, width, arena);
  if (!blobs.ok()) {
    return blobs.error();
  }
  MarkerFinder finder(config, width, blobs.value(), arena);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return finder;
}

MarkerFinder::Report MarkerFinder::run(const depth::DepthImage& frame,
                                       Buffer<Marker>& out) noexcept {
  Report report;
  out.clear();
  const std::size_t pixels = std::size_t{frame.intrinsics.width} * frame.intrinsics.height;
  report.gray_usable = frame.intrinsics.width == width_ && frame.gray.size() == pixels &&
                       pixels > 0 && (frame.depth.empty() || frame.depth.size() == pixels);
  if (!report.gray_usable) {
    return report;
  }
  report.blobs = blobs_.run(frame.gray);
  for (std::uint32_t i = 0; i < report.blobs.blobs; ++i) {
    const Blob& blob = blobs_.blobs()[i];
    if (blob.parent == i && worth_a_look(blob, config_, width_)) {
      ++report.candidates;
      examine(frame, blob, report, out);
    }
  }
  return report;
}

void MarkerFinder::examine(const depth::DepthImage& frame, const Blob& blob, Report& report,
                           Buffer<Marker>& out) noexcept {
  const geometry::Ellipse start = moment_ellipse(blob);
  if (!ellipse_like(blob, start, config_)) {
    ++report.rejected_shape;
    return;
  }
  const EllipseEdge edge = refine_ellipse(frame, start, blob.polarity == Polarity::kDarkOnLight);
  if (!edge_is_a_rim(edge, config_)) {
    ++report.rejected_edge;
    return;
  }
  Marker marker;
  marker.ellipse = edge.ellipse;
  marker.u = edge.ellipse.u;
  marker.v = edge.ellipse.v;
  marker.polarity = blob.polarity;
  marker.sigma_px = std::hypot(kFloorPx, edge.sigma_px);
  if (!frame.depth.empty() && !lay(frame, edge, marker, report)) {
    return;
  }
  ++report.found;
  report.not_stored += out.append(marker) ? 0U : 1U;
}

bool MarkerFinder::lay(const depth::DepthImage& frame, const EllipseEdge& edge, Marker& marker,
                       Report& report) noexcept {
  const SurfaceDisc disc = lay_on_surface(frame, edge, config_.max_hole_depth_mm, ring_);
  if (disc.state != DiscState::kDisc) {
    ++(disc.state == DiscState::kHole ? report.rejected_hole : report.rejected_surface);
    return false;
  }
  if (disc.radius_mm < config_.min_radius_mm || disc.radius_mm > config_.max_radius_mm) {
    ++report.rejected_size;
    return false;
  }
  set_space(frame, disc, config_.sigma_depth_mm, marker);
  return true;
}

}  // namespace dseam::markers
