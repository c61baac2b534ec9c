// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/edge/edge_scanner.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace dseam::seam {
namespace {

constexpr double kReachMm = 8.0;   // Widest gap, plus a few pixels of the surface.
constexpr double kInsideMm = 1.0;  // Deeper than this in the other one is its inside.
constexpr double kBehindMm = 60.0;
constexpr double kMarginMm = 0.1;
constexpr double kMarginNoises = 4.0;
constexpr std::size_t kMaxApart = 24;  // A dead band lies between the two.
constexpr std::size_t kMaxFlying = 3;
constexpr std::size_t kSurfaceRun = 2;  // Pixels beside the last one.
constexpr double kLineMm = 0.8;         // Between two lines that are walked.
constexpr int kRays = 360;
constexpr double kRayStepMm = 2.0;
constexpr std::uint32_t kNoiseStride = 8;

Eigen::Vector3d ray_of(const depth::Intrinsics& k, double u, double v) noexcept {
  return {(u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0};
}

}  // namespace

void EdgeScanner::run(std::span<const depth::DepthImage> frames,
                      std::span<const splice::SplicedView> views, const EndingSurface& surface,
                      double noise_mm) noexcept {
  surface_ = surface;
  margin_mm_ = kMarginMm + kMarginNoises * std::max(noise_mm, pixel_noise_mm(frames, views));
  shape_ = {};
  scan(frames, views);
  if (look_again()) {
    scan(frames, views);
  }
  smear_mm_ = shape_.is_smeared ? mean_width_mm() : 0.0;
}

void EdgeScanner::scan(std::span<const depth::DepthImage> frames,
                       std::span<const splice::SplicedView> views) noexcept {
  intervals_.clear();
  full_ = false;
  for (std::size_t i = 0; i < std::min(frames.size(), views.size()); ++i) {
    if (views[i].state != splice::ViewState::kUsed) {
      continue;
    }
    T_base_camera_ = views[i].T_base_camera;
    const Window w = window_of(frames[i].intrinsics);
    const std::uint32_t stride = stride_of(frames[i].intrinsics);
    for (std::uint32_t v = w.v0; v < w.v1; v += stride) {
      scan_line(frames[i], {w.u0, v, true}, std::min<std::size_t>(w.u1 - w.u0, kMaxLine));
    }
    for (std::uint32_t u = w.u0; u < w.u1; u += stride) {
      scan_line(frames[i], {u, w.v0, false}, std::min<std::size_t>(w.v1 - w.v0, kMaxLine));
    }
  }
}

// Lines this many pixels apart lie as far from each other on the part, whatever the camera.
std::uint32_t EdgeScanner::stride_of(const depth::Intrinsics& k) const noexcept {
  const Eigen::Vector3d p = T_base_camera_.inverse() * surface_.fit().joint().nozzle.point;
  const double pixel_mm = std::max(1e-3, p.z() / k.fx);
  return static_cast<std::uint32_t>(std::clamp(kLineMm / pixel_mm, 1.0, 8.0));
}

// A fused point is the mean of several pixels; a single one scatters more, and it is single pixels
// that are told apart here. The median is the surface's even where a gap is seen.
double EdgeScanner::pixel_noise_mm(std::span<const depth::DepthImage> frames,
                                   std::span<const splice::SplicedView> views) noexcept {
  constexpr double kBinMm = 0.01;
  constexpr double kSigmaOfMedian = 1.4826;
  std::array<std::uint32_t, 128> histogram{};
  std::uint32_t total = 0;
  for (std::size_t i = 0; i < std::min(frames.size(), views.size()); ++i) {
    if (views[i].state != splice::ViewState::kUsed) {
      continue;
    }
    T_base_camera_ = views[i].T_base_camera;
    const Window w = window_of(frames[i].intrinsics);
    for (std::uint32_t v = w.v0; v < w.v1; v += kNoiseStride) {
      for (std::uint32_t u = w.u0; u < w.u1; u += kNoiseStride) {
        const double off_mm = off_surface_mm(frames[i], u, v);
        const auto bin = static_cast<std::size_t>(std::min(off_mm / kBinMm, 127.0));
        histogram[bin] += off_mm < 128.0 * kBinMm ? 1U : 0U;
        total += off_mm < 128.0 * kBinMm ? 1U : 0U;
      }
    }
  }
  std::uint32_t below = 0;
  std::size_t median = 0;
  while (median < histogram.size() && (below += histogram[median]) < (total + 1) / 2) {
    ++median;
  }
  return kSigmaOfMedian * kBinMm * static_cast<double>(median);
}

// How far a pixel of the surface beside the joint lies from the fit; infinite for all others.
double EdgeScanner::off_surface_mm(const depth::DepthImage& frame, std::uint32_t u,
                                   std::uint32_t v) const noexcept {
  const double z = frame.count_at(u, v) * frame.mm_per_count;
  const Eigen::Vector3d p = T_base_camera_ * (z * ray_of(frame.intrinsics, u, v));
  const double outside = surface_.rough_away(p);
  const bool beside = z > 0.0 && outside > 0.5 * kReachMm && outside < 2.0 * kReachMm &&
                      std::abs(surface_.rough_off(p)) < 2.0;
  return beside ? std::abs(surface_.off(p)) : std::numeric_limits<double>::infinity();
}

// The part of the image in which the joint and the surface around it lie, and which blocks of it.
EdgeScanner::Window EdgeScanner::window_of(const depth::Intrinsics& k) noexcept {
  const geometry::RigidTransform T_camera_base = T_base_camera_.inverse();
  std::fill(blocks_.begin(), blocks_.end(), std::uint8_t{0});
  Window w{k.width, k.height, 0, 0};
  for (int i = 0; i < kRays; ++i) {
    const double phi = 2.0 * std::numbers::pi * i / kRays;
    const auto root = surface_.root_at(phi);
    if (!root) {
      continue;
    }
    const Eigen::Vector3d n = surface_.outwards(*root);
    for (double away_mm = 0.0; away_mm <= kReachMm; away_mm += kRayStepMm) {
      const Eigen::Vector3d p = T_camera_base * (*root + away_mm * n);
      const double u = k.fx * p.x() / p.z() + k.cx;
      const double v = k.fy * p.y() / p.z() + k.cy;
      if (p.z() > 1.0 && u >= 0.0 && v >= 0.0 && u < std::min<double>(k.width, kMaxLine) &&
          v < std::min<double>(k.height, kMaxLine)) {
        mark({static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v)}, k, w);
      }
    }
  }
  return w;
}

// The pixel's block and those around it.
void EdgeScanner::mark(const PixelPlace& at, const depth::Intrinsics& k, Window& w) noexcept {
  const std::uint32_t bu = at.u / kBlock;
  const std::uint32_t bv = at.v / kBlock;
  for (std::uint32_t y = bv - std::min<std::uint32_t>(bv, 1);
       y <= std::min(bv + 1, kBlocksAcross - 1); ++y) {
    for (std::uint32_t x = bu - std::min<std::uint32_t>(bu, 1);
         x <= std::min(bu + 1, kBlocksAcross - 1); ++x) {
      blocks_[y * kBlocksAcross + x] = 1;
    }
  }
  w.u0 = std::min(w.u0, at.u - std::min(at.u, kBlock));
  w.v0 = std::min(w.v0, at.v - std::min(at.v, kBlock));
  w.u1 = std::max(w.u1, std::min(at.u + kBlock, k.width));
  w.v1 = std::max(w.v1, std::min(at.v + kBlock, k.height));
}

EdgeScanner::Pixel EdgeScanner::classify(const depth::DepthImage& frame, std::uint32_t u,
                                         std::uint32_t v) const noexcept {
  const double z = frame.count_at(u, v) * frame.mm_per_count;
  if (!(z > 0.0)) {
    return {};
  }
  const Eigen::Vector3d p = T_base_camera_ * (z * ray_of(frame.intrinsics, u, v));
  const double outside = surface_.rough_away(p);
  const double rough = surface_.rough_off(p);
  const auto z_mm = static_cast<float>(z);
  if (!(outside > -kInsideMm && outside < kReachMm && rough < 2.0 * margin_mm_ + 1.0 &&
        rough > -kBehindMm) ||
      !surface_.is_beside(p)) {
    return {Kind::kOther, z_mm};
  }
  const double above = rough < -2.0 ? rough : surface_.off(p);
  if (above > margin_mm_) {
    return {Kind::kOther, z_mm};
  }
  if (above > -kSurfaceShare * margin_mm_) {
    return {Kind::kSurface, z_mm};
  }
  return {above < -margin_mm_ ? Kind::kBehind : Kind::kNothing, z_mm};
}

void EdgeScanner::scan_line(const depth::DepthImage& frame, const Step& start,
                            std::size_t count) noexcept {
  constexpr std::size_t kNone = SIZE_MAX;
  for (std::size_t i = 0; i < count; ++i) {
    const auto step = static_cast<std::uint32_t>(i);
    const std::uint32_t u = start.u + (start.along_u ? step : 0);
    const std::uint32_t v = start.v + (start.along_u ? 0 : step);
    const bool near = blocks_[v / kBlock * kBlocksAcross + u / kBlock] != 0;
    line_[i] = near ? classify(frame, u, v) : Pixel{Kind::kOther, 0.0F};
  }
  std::size_t last = kNone;
  for (std::size_t i = 0; i < count; ++i) {
    const Kind kind = line_[i].kind;
    if (kind == Kind::kNothing) {
      continue;
    }
    if (kind == Kind::kOther) {
      last = kNone;
      continue;
    }
    if (last != kNone && line_[last].kind != kind && i - last <= kMaxApart) {
      kind == Kind::kSurface ? try_pair(frame, start, i, last, count)
                             : try_pair(frame, start, last, i, count);
    }
    last = i;
  }
}

// Through the line's pixel, 1 along the optical axis.
Eigen::Vector3d EdgeScanner::ray_base(const depth::DepthImage& frame, const Step& start,
                                      std::size_t i) const noexcept {
  const double u = start.u + (start.along_u ? static_cast<double>(i) : 0.0);
  const double v = start.v + (start.along_u ? 0.0 : static_cast<double>(i));
  return T_base_camera_.rotation * ray_of(frame.intrinsics, u, v);
}

// The pixel's place on the fitted surface, whether that is there or not.
std::optional<Eigen::Vector3d> EdgeScanner::on_surface(const depth::DepthImage& frame,
                                                       const Step& start,
                                                       std::size_t i) const noexcept {
  const Eigen::Vector3d direction = ray_base(frame, start, i);
  Eigen::Vector3d p = T_base_camera_.translation_mm + double{line_[i].z_mm} * direction;
  for (int k = 0; k < 4; ++k) {
    const double slope = surface_.normal(p).dot(direction);
    if (!(slope < -0.05 * direction.norm())) {
      return std::nullopt;
    }
    p -= surface_.off(p) / slope * direction;
  }
  return p;
}

// A flying pixel hangs between two depths; it does not lie on the line through the next two. It may
// have been a pixel of the surface, and so may the one after it: the first that fits is sure.
std::optional<std::size_t> EdgeScanner::first_sure(std::size_t last, std::size_t behind,
                                                   std::size_t count) const noexcept {
  const bool forward = behind > last;
  for (std::size_t k = 0; k < kMaxFlying; ++k) {
    if (forward ? behind + k + 2 >= count : behind < k + 2) {
      return std::nullopt;
    }
    const std::size_t i = forward ? behind + k : behind - k;
    const Pixel& next = line_[forward ? i + 1 : i - 1];
    const Pixel& after = line_[forward ? i + 2 : i - 2];
    if (line_[i].kind == Kind::kSurface || line_[i].kind == Kind::kOther) {
      return std::nullopt;
    }
    const double bend = line_[i].z_mm - 2.0F * next.z_mm + after.z_mm;
    if (line_[i].kind == Kind::kBehind && next.kind != Kind::kNothing &&
        after.kind != Kind::kNothing && std::abs(bend) < margin_mm_) {
      return i;
    }
  }
  return std::nullopt;
}

// The surface goes on away from the edge: one pixel of its height alone may be a flying one.
bool EdgeScanner::goes_on(std::size_t last, std::size_t behind, std::size_t count) const noexcept {
  const bool forward = last > behind;
  bool found = false;
  for (std::size_t k = 1; k <= kSurfaceRun; ++k) {
    if (forward ? last + k >= count : last < k) {
      return false;
    }
    const Kind kind = line_[forward ? last + k : last - k].kind;
    if (kind == Kind::kBehind || kind == Kind::kOther) {
      return false;
    }
    found = found || kind == Kind::kSurface;
  }
  return found;
}

void EdgeScanner::try_pair(const depth::DepthImage& frame, const Step& start, std::size_t last,
                           std::size_t behind, std::size_t count) noexcept {
  const std::optional<std::size_t> sure = first_sure(last, behind, count);
  if (!sure || !goes_on(last, behind, count)) {
    return;
  }
  const auto low = on_surface(frame, start, *sure);
  const auto high = on_surface(frame, start, last);
  if (!low || !high) {
    return;
  }
  const double low_mm = surface_.away(*low);
  const double high_mm =
      surface_.away(*high) + past_edge_mm(frame, start, last, *high) + shape_.reach_mm;
  if (low_mm < high_mm && low_mm > -kInsideMm && high_mm < kReachMm) {
    const double phi = surface_.angle_of(0.5 * (*low + *high));
    const EdgeInterval seen{phi, low_mm, high_mm};
    const EdgeInterval edge = by_shape(frame, start, {last, *sure, count}, seen);
    full_ = !intervals_.append(edge) || full_;
  }
}

}  // namespace dseam::seam
