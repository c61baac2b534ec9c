// SPDX-License-Identifier: Apache-2.0
#include "markers/rim/gray_profile.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace dseam::markers {
namespace {

constexpr std::size_t kMaxSamples = 33;
constexpr double kStepPx = 0.5;
// Pixels nearer to the rim show both sides of it. What blur leaves of it beyond is alike all round.
constexpr double kRimPx = 1.0;

// One gray profile across the rim, from inside to outside, turned so that it rises.
struct Profile {
  std::array<double, kMaxSamples> gray;
  std::size_t count = 0;
  double first_px = 0.0;    // Offset of the first sample from the rim, negative inside.
  double disc_slope = 0.0;  // Of the levels on either side, per sample.
  double ground_slope = 0.0;

  [[nodiscard]] double low(std::size_t i) const noexcept {
    return (gray[0] + gray[1]) / 2.0 + disc_slope * (static_cast<double>(i) - 0.5);
  }
  [[nodiscard]] double high(std::size_t i) const noexcept {
    const double last = static_cast<double>(count) - 1.5;
    return (gray[count - 1] + gray[count - 2]) / 2.0 +
           ground_slope * (static_cast<double>(i) - last);
  }
};

Profile read_profile(const depth::DepthImage& frame, const Eigen::Vector2d& rim_px,
                     const Eigen::Vector2d& normal, double reach_px, double sign) noexcept {
  Profile p;
  p.first_px = -reach_px;
  const auto samples = static_cast<std::size_t>(2.0 * reach_px / kStepPx) + 1;
  for (std::size_t i = 0; i < std::min(samples, kMaxSamples); ++i) {
    const Eigen::Vector2d q = rim_px + normal * (p.first_px + static_cast<double>(i) * kStepPx);
    if (!inside_image(frame, q.x(), q.y())) {
      return {};
    }
    p.gray[p.count++] = sign * gray_between(frame, q.x(), q.y());
  }
  return p;
}

// The step that has the profile's area: it averages noise, where a single crossing does not.
double equal_area_edge(const Profile& p) noexcept {
  double inside = 0.0;
  for (std::size_t i = 0; i < p.count; ++i) {
    const double low = p.low(i);
    const double high = p.high(i);
    const double share = std::clamp((high - p.gray[i]) / std::max(high - low, 1.0), 0.0, 1.0);
    inside += i == 0 || i + 1 == p.count ? 0.5 * share : share;
  }
  return p.first_px + inside * kStepPx;
}

double steepest(const Profile& p) noexcept {
  double slope = 0.0;
  for (std::size_t i = 0; i + 2 < p.count; ++i) {
    slope = std::max(slope, (p.gray[i + 2] - p.gray[i]) / (2.0 * kStepPx));
  }
  return slope;
}

struct PlaneSums {
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double squares = 0.0;
  double count = 0.0;

  void add(double x, double y, double gray) noexcept {
    const Eigen::Vector3d row(1.0, x, y);
    h.noalias() += row * row.transpose();
    g += row * gray;
    squares += gray * gray;
    count += 1.0;
  }
  // Its slope, when gray lies on a plane: structure beside the disc is not shading.
  [[nodiscard]] Eigen::Vector2d slope() const noexcept {
    constexpr double kMinPixels = 8.0;
    constexpr double kMaxRmsGray = 6.0;
    if (count < kMinPixels) {
      return Eigen::Vector2d::Zero();
    }
    const Eigen::Vector3d plane = h.ldlt().solve(g);
    const double left = std::max(0.0, squares - plane.dot(g)) / count;
    const bool flat = left < kMaxRmsGray * kMaxRmsGray && plane.allFinite();
    return flat ? Eigen::Vector2d(plane.tail<2>()) : Eigen::Vector2d::Zero();
  }
};

}  // namespace

double gray_between(const depth::DepthImage& frame, double u, double v) noexcept {
  const auto u0 = static_cast<std::uint32_t>(u);
  const auto v0 = static_cast<std::uint32_t>(v);
  const double fu = u - u0;
  const double fv = v - v0;
  const double upper = (1.0 - fu) * frame.gray_at(u0, v0) + fu * frame.gray_at(u0 + 1, v0);
  const double lower = (1.0 - fu) * frame.gray_at(u0, v0 + 1) + fu * frame.gray_at(u0 + 1, v0 + 1);
  return (1.0 - fv) * upper + fv * lower;
}

bool inside_image(const depth::DepthImage& frame, double u, double v) noexcept {
  return u >= 0.0 && v >= 0.0 && u < frame.intrinsics.width - 1.0 &&
         v < frame.intrinsics.height - 1.0;
}

Shading shading_about(const depth::DepthImage& frame, const geometry::Ellipse& rim,
                      double reach_px) noexcept {
  PlaneSums disc;
  PlaneSums ground;
  const double out = rim.a + reach_px + 1.0;
  const auto step = static_cast<int>(std::clamp(out / 16.0, 1.0, 1e4));
  const auto u0 = static_cast<int>(rim.u);
  const auto v0 = static_cast<int>(rim.v);
  const auto far = static_cast<int>(out);
  const geometry::EllipseGauge gauge(rim);
  for (int v = v0 - far; v <= v0 + far; v += step) {
    for (int u = u0 - far; u <= u0 + far; u += step) {
      if (!inside_image(frame, u, v)) {
        continue;
      }
      const double beyond_px = (gauge.radius(u, v) - 1.0) * rim.b;
      if (std::abs(beyond_px) < kRimPx || beyond_px > reach_px) {
        continue;
      }
      const double gray =
          frame.gray_at(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v));
      (beyond_px < 0.0 ? disc : ground).add(u - rim.u, v - rim.v, gray);
    }
  }
  return {disc.slope(), ground.slope()};
}

std::optional<EdgePoint> find_edge(const depth::DepthImage& frame, const Eigen::Vector2d& rim_px,
                                   const Eigen::Vector2d& normal, double reach_px,
                                   const Shading& shading, double sign) noexcept {
  constexpr double kMinStep = 8.0;
  Profile p = read_profile(frame, rim_px, normal, reach_px, sign);
  if (p.count < 5) {
    return std::nullopt;
  }
  p.disc_slope = sign * kStepPx * shading.disc.dot(normal);
  p.ground_slope = sign * kStepPx * shading.ground.dot(normal);
  const std::size_t middle = p.count / 2;
  const double step = p.high(middle) - p.low(middle);
  if (step < kMinStep) {
    return std::nullopt;
  }
  return EdgePoint{rim_px + normal * equal_area_edge(p), step / std::max(steepest(p), 1e-6), step};
}

}  // namespace dseam::markers
