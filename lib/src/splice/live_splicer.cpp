// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/live_splicer.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "splice/network/surface_ties.hpp"

namespace dseam::splice {
namespace {

constexpr std::uint32_t kReferenceStride = 2;  // Every how many blocks a patch is looked at.

}  // namespace

struct LiveSplicer::Sums {
  geometry::Matrix6 h = geometry::Matrix6::Zero();
  geometry::Vector6 g = geometry::Vector6::Zero();
  double weight = 0.0;
  double squares = 0.0;
  double reach_squares = 0.0;
  std::uint32_t near = 0;
  std::uint32_t wide = 0;

  void add(const SurfaceSight& mine, const SurfaceSight& theirs, const Eigen::Vector3d& pivot,
           double gate_mm, double wide_gate_mm) noexcept {
    const double height = mine.n_base.dot(mine.p_base - theirs.p_base);
    wide += std::abs(height) < wide_gate_mm ? 1U : 0U;
    if (!(std::abs(height) < gate_mm)) {
      return;
    }
    const Eigen::Vector3d arm = mine.p_base - pivot;
    geometry::Vector6 j;
    j << mine.n_base, arm.cross(mine.n_base);
    const double s = height / gate_mm;
    const double w = (1.0 - s * s) * (1.0 - s * s);
    h += w * j * j.transpose();
    g += w * height * j;
    weight += w;
    squares += w * height * height;
    reach_squares += arm.squaredNorm();
    ++near;
  }
};

void LiveSplicer::tie(const PosedView& view, std::span<const PosedView> others,
                      const Eigen::Vector3d& pivot, double gate_mm, Sums& sums) const noexcept {
  const Eigen::Vector2d no_bowl = Eigen::Vector2d::Zero();
  for (std::uint32_t row = 0; row < view.field.rows; row += kReferenceStride) {
    for (std::uint32_t column = 0; column < view.field.columns; column += kReferenceStride) {
      const Eigen::Vector2d c = view.field.centre_px(column, row);
      const SurfaceSight mine = sight_at(view, c.x(), c.y(), no_bowl);
      for (std::size_t v = 0; mine.valid && v < others.size(); ++v) {
        const SurfaceSight theirs =
            others[v].used ? sight_of(others[v], mine, no_bowl) : SurfaceSight{};
        if (theirs.valid) {
          sums.add(mine, theirs, pivot, gate_mm, config_.start_gate_mm);
        }
      }
    }
  }
}

namespace {

struct Seen {
  double before = 0.0;
  double near = 0.0;
};

// How far a point lies before what a view saw there and all round it, where it saw a surface; no
// more than `most_mm` where it did not: at an edge nothing is sure.
double height_before(const PosedView& view, const Eigen::Vector3d& p, double most_mm) noexcept {
  constexpr double kAround = PatchField::kBlockPx;
  constexpr std::array<std::array<double, 2>, 4> kCorners = {
      {{-kAround, -kAround}, {kAround, -kAround}, {-kAround, kAround}, {kAround, kAround}}};
  const depth::Intrinsics& k = view.field.intrinsics;
  const double u = k.fx * p.x() / p.z() + k.cx;
  const double v = k.fy * p.y() / p.z() + k.cy;
  const SurfacePoint middle = surface_at(view.field, u, v);
  double height = middle.n_camera.dot(p - middle.p_camera);
  for (const auto& [du, dv] : kCorners) {
    const SurfacePoint corner = surface_at(view.field, u + du, v + dv);
    const double above = corner.n_camera.dot(p - corner.p_camera);
    height = std::min(height, corner.valid ? above : most_mm);
  }
  return middle.valid ? height : -std::numeric_limits<double>::infinity();
}

// What a view measured hides nothing that another one saw: if it lies before that, one of the poses
// is wrong. What lies behind is hidden, and says nothing.
void look(const PosedView& from, const PosedView& at, double tolerance_mm, Seen& seen) noexcept {
  const geometry::RigidTransform T_from_at = from.T_camera_base * at.T_base_camera;
  for (std::uint32_t row = 0; row < at.field.rows; row += kReferenceStride) {
    for (std::uint32_t column = 0; column < at.field.columns; column += kReferenceStride) {
      const Eigen::Vector2d c = at.field.centre_px(column, row);
      const SurfacePoint there = surface_at(at.field, c.x(), c.y());
      const Eigen::Vector3d p = T_from_at * there.p_camera;
      if (there.valid && p.z() > 1.0) {
        const double height = height_before(from, p, tolerance_mm);
        seen.before += height > tolerance_mm ? 1.0 : 0.0;
        seen.near += std::abs(height) <= tolerance_mm ? 1.0 : 0.0;
      }
    }
  }
}

// What the middle of the image shows.
Eigen::Vector3d pivot_of(const PosedView& view) noexcept {
  constexpr double kUsualDistanceMm = 600.0;
  const depth::Intrinsics& k = view.field.intrinsics;
  const SurfacePoint middle = surface_at(view.field, k.cx, k.cy);
  return view.T_base_camera *
         (middle.valid ? middle.p_camera : Eigen::Vector3d(0.0, 0.0, kUsualDistanceMm));
}

}  // namespace

double LiveSplicer::share_before(const PosedView& view,
                                 std::span<const PosedView> others) const noexcept {
  constexpr double kBeforeMm = 3.0;
  Seen seen;
  for (const PosedView& other : others) {
    if (other.used) {
      look(view, other, kBeforeMm, seen);
      look(other, view, kBeforeMm, seen);
    }
  }
  return seen.before / std::max(1.0, seen.before + seen.near);
}

LiveSplicer::Report LiveSplicer::run(const PosedView& start,
                                     std::span<const PosedView> others) const noexcept {
  Report report;
  report.T_base_camera = start.T_base_camera;
  if (std::none_of(others.begin(), others.end(), [](const PosedView& v) { return v.used; })) {
    report.state = State::kFirst;
    return report;
  }
  PosedView view = start;
  const Eigen::Vector3d pivot = pivot_of(start);
  double gate = config_.start_gate_mm;
  for (report.iterations = 1; report.iterations <= config_.max_iterations; ++report.iterations) {
    Sums sums;
    tie(view, others, pivot, gate, sums);
    report.num_ties = sums.near;
    report.rms_mm = sums.weight > 0.0 ? std::sqrt(sums.squares / sums.weight) : 0.0;
    report.share_near = static_cast<double>(sums.near) / std::max<std::uint32_t>(1, sums.wide);
    if (sums.near < config_.min_ties) {
      report.state = State::kNoOverlap;
      return report;
    }
    if (report.iterations == 1) {
      report.observability = find_frozen(
          sums.h, sums.weight, std::sqrt(sums.reach_squares / sums.near), config_.min_sensitivity);
    }
    const geometry::Vector6 step = report.observability.solve(sums.h, sums.g);
    const Eigen::Matrix3d turn = geometry::rotation_exp(step.tail<3>());
    const geometry::RigidTransform& T_base_camera = view.T_base_camera;
    view.place({turn * T_base_camera.rotation,
                turn * (T_base_camera.translation_mm - pivot) + pivot + step.head<3>()});
    const bool last_gate = gate <= std::max(config_.final_gate_mm, 5.0 * report.rms_mm);
    if (last_gate && step.norm() < 1e-3) {
      break;
    }
    gate = std::max(0.5 * gate, config_.final_gate_mm);
  }
  report.T_base_camera = view.T_base_camera;
  report.share_before = share_before(view, others);
  const bool holds = report.share_near >= config_.min_share_near;
  report.state = holds ? State::kSpliced : State::kContradicts;
  return report;
}

}  // namespace dseam::splice
