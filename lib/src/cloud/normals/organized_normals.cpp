// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/organized_normals.hpp"

#include <algorithm>
#include <cmath>

#include "../../depth/count_lanes.hpp"
#include "../../geometry/vec3_lanes.hpp"
#include "dseam/base/expects.hpp"

namespace dseam::cloud {
namespace {

using lanes::FloatLanes;
using lanes::IntLanes;
using lanes::kLanes;
using lanes::splat;

constexpr std::uint32_t kMaxHalfWindow = 15;

// Sums over the window: columns and rows against the centre, and inverse depth against it.
struct WindowSums {
  FloatLanes n, u, v, w, uu, uv, vv, uw, vw, ww;

  WindowSums() noexcept { n = u = v = w = uu = uv = vv = uw = vw = ww = splat(0.0F); }
  void add(const IntLanes& near, float du, float dv, const FloatLanes& dw) noexcept {
    const FloatLanes one = lanes::keep(near, splat(1.0F));
    const FloatLanes kw = lanes::keep(near, dw);
    n = n + one;
    u = u + one * splat(du);
    v = v + one * splat(dv);
    w = w + kw;
    uu = uu + one * splat(du * du);
    uv = uv + one * splat(du * dv);
    vv = vv + one * splat(dv * dv);
    uw = uw + kw * splat(du);
    vw = vw + kw * splat(dv);
    ww = ww + kw * kw;
  }
};

// w = slope_u * du + slope_v * dv + at_centre, and what is left over.
struct PlaneFit {
  FloatLanes slope_u, slope_v, at_centre;
  FloatLanes determinant;  ///< 0 when the window's pixels lie in one line.
  FloatLanes rest;         ///< Mean square.
  FloatLanes spread_u, spread_v;
};

PlaneFit fit(const WindowSums& s) noexcept {
  const FloatLanes share = splat(1.0F) / lanes::max(s.n, splat(1.0F));
  const FloatLanes mu = s.u * share;
  const FloatLanes mv = s.v * share;
  const FloatLanes mw = s.w * share;
  const FloatLanes cuu = s.uu * share - mu * mu;
  const FloatLanes cuv = s.uv * share - mu * mv;
  const FloatLanes cvv = s.vv * share - mv * mv;
  const FloatLanes cuw = s.uw * share - mu * mw;
  const FloatLanes cvw = s.vw * share - mv * mw;
  const FloatLanes cww = s.ww * share - mw * mw;
  const FloatLanes determinant = cuu * cvv - cuv * cuv;
  const FloatLanes inverse = splat(1.0F) / lanes::max(determinant, splat(1.0e-3F));
  const FloatLanes a = (cuw * cvv - cvw * cuv) * inverse;
  const FloatLanes b = (cvw * cuu - cuw * cuv) * inverse;
  const FloatLanes rest = lanes::max(cww - a * cuw - b * cvw, splat(0.0F));
  return {a, b, mw - a * mu - b * mv, determinant, rest, cuu, cvv};
}

// On the plane 1/z is n dot (ray x, ray y, 1): this n points away from the camera.
geometry::Vec3Lanes away_from_camera(const PlaneFit& plane, const FloatLanes& inverse_z,
                                     const depth::Intrinsics& k, std::uint32_t u,
                                     std::uint32_t v) noexcept {
  static constexpr float kSteps[kLanes] = {0, 1, 2, 3, 4, 5, 6, 7};
  const FloatLanes off_u =
      lanes::load(kSteps) + splat(static_cast<float>(static_cast<double>(u) - k.cx));
  const FloatLanes off_v = splat(static_cast<float>(static_cast<double>(v) - k.cy));
  return {plane.slope_u * splat(static_cast<float>(k.fx)),
          plane.slope_v * splat(static_cast<float>(k.fy)),
          inverse_z + plane.at_centre - plane.slope_u * off_u - plane.slope_v * off_v};
}

bool is_in(const depth::DepthImage& image, std::uint32_t u, std::uint32_t v) noexcept {
  return depth::has_sensible_shape(image) && u < image.intrinsics.width &&
         v < image.intrinsics.height;
}

// What the window's pixels are measured against.
struct Centre {
  std::uint32_t u, v;  ///< Of the first of eight.
  FloatLanes z;
  FloatLanes inverse_z;
  IntLanes valid;
};

WindowSums sums_around(const OrganizedNormals::Config& config, const depth::DepthImage& image,
                       const Centre& centre) noexcept {
  const auto half = static_cast<std::int32_t>(config.half_window);
  const FloatLanes mm = splat(static_cast<float>(image.mm_per_count));
  WindowSums sums;
  for (std::int32_t dv = -half; dv <= half; ++dv) {
    for (std::int32_t du = -half; du <= half; ++du) {
      const IntLanes counts =
          depth::counts_at(image, std::int64_t{centre.u} + du, std::int64_t{centre.v} + dv, 1);
      const FloatLanes other = lanes::to_float(counts) * mm;
      const auto steps = static_cast<float>(std::max(std::abs(du), std::abs(dv)));
      const FloatLanes limit = splat(config.max_step_mm * steps);
      const IntLanes near =
          centre.valid & (splat(0) < counts) & (lanes::magnitude(other - centre.z) <= limit);
      // 1/other - 1/z without the cancellation of the two.
      const FloatLanes safe = lanes::select(near, other, splat(1.0F));
      sums.add(near, static_cast<float>(du), static_cast<float>(dv),
               (centre.z - other) * centre.inverse_z / safe);
    }
  }
  return sums;
}

}  // namespace

struct OrganizedNormals::Eight {
  geometry::Vec3Lanes normal;
  FloatLanes variation;
  std::uint32_t too_few;
  std::uint32_t collinear;

  [[nodiscard]] Normal operator[](std::size_t i) const noexcept {
    if ((too_few >> i & 1U) != 0) {
      return {{}, 0.0F, NormalState::kTooFew};
    }
    if ((collinear >> i & 1U) != 0) {
      return {{}, 0.0F, NormalState::kCollinear};
    }
    return {{normal.x[i], normal.y[i], normal.z[i]}, variation[i], NormalState::kGood};
  }
};

Result<OrganizedNormals> OrganizedNormals::make(const Config& config) noexcept {
  const bool sensible = config.half_window >= 1 && config.half_window <= kMaxHalfWindow &&
                        config.max_step_mm > 0.0F && std::isfinite(config.max_step_mm);
  if (!sensible) {
    return Errc::kInvalidArgument;
  }
  return OrganizedNormals(config);
}

OrganizedNormals::Eight OrganizedNormals::fit_eight(const depth::DepthImage& image, std::uint32_t u,
                                                    std::uint32_t v) const noexcept {
  const depth::Intrinsics& k = image.intrinsics;
  const IntLanes counts = depth::counts_at(image, u, v, 1);
  const FloatLanes z = lanes::to_float(counts) * splat(static_cast<float>(image.mm_per_count));
  const IntLanes valid = splat(0) < counts;
  const FloatLanes inverse_z = splat(1.0F) / lanes::select(valid, z, splat(1.0F));
  const WindowSums sums = sums_around(config_, image, {u, v, z, inverse_z, valid});
  const PlaneFit plane = fit(sums);
  const auto fx = static_cast<float>(k.fx);
  const auto fy = static_cast<float>(k.fy);
  const FloatLanes zero = splat(0.0F);
  const geometry::Vec3Lanes away = away_from_camera(plane, inverse_z, k, u, v);
  const FloatLanes square = geometry::dot(away, away);
  const geometry::Vec3Lanes normal =
      geometry::scaled(away, (zero - splat(1.0F)) / lanes::sqrt(square));
  // The distance from the plane is z times the rest of n dot ray, over the length of n.
  const FloatLanes off_plane = plane.rest * z * z / square;
  const FloatLanes across =
      z * z * (plane.spread_u * splat(1.0F / (fx * fx)) + plane.spread_v * splat(1.0F / (fy * fy)));
  const FloatLanes few =
      splat(static_cast<float>(std::max<std::uint32_t>(config_.min_neighbours, 3)));
  return {normal, off_plane / (off_plane + across), lanes::bits(sums.n < few),
          lanes::bits(plane.determinant <= splat(1.0e-3F))};
}

OrganizedNormals::Normal OrganizedNormals::at(const depth::DepthImage& image, std::uint32_t u,
                                              std::uint32_t v) const noexcept {
  return is_in(image, u, v) ? fit_eight(image, u, v)[0] : Normal{};
}

std::uint32_t OrganizedNormals::run_row(const depth::DepthImage& image, std::uint32_t v,
                                        NormalsBuffer& out) const noexcept {
  const std::uint32_t width = image.intrinsics.width;
  DSEAM_EXPECTS(width <= out.capacity());
  std::uint32_t good = 0;
  for (std::uint32_t u = 0; u < width; u += kLanes) {
    const bool usable = is_in(image, u, v);
    const Eight eight = usable ? fit_eight(image, u, v) : Eight{{}, {}, 0xFFU, 0};
    for (std::uint32_t i = 0; i < kLanes && u + i < width; ++i) {
      const Normal normal = eight[i];
      out.set(u + i, normal.direction, normal.variation, normal.state);
      good += normal.state == NormalState::kGood ? 1U : 0U;
    }
  }
  return good;
}

}  // namespace dseam::cloud
