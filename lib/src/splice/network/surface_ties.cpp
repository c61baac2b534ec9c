// SPDX-License-Identifier: Apache-2.0
#include "splice/network/surface_ties.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dseam::splice {
namespace {

using Row6 = Eigen::Matrix<double, 1, 6>;

constexpr double kMinNormalAgreement = 0.9;
constexpr std::uint32_t kMinTiesOfALink = 20;

// One view's height over the reference along its normal, and what the height depends on.
struct Member {
  std::size_t view = 0;
  double height = 0.0;
  double weight = 1.0;
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
};

struct Group {
  std::array<Member, cloud::kMaxViews> members;
  std::size_t count = 0;
  // One arm for all, or noise would turn all views together.
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d others = Eigen::Vector3d::Zero();  // Sum of all normals but the reference's.

  void add(std::size_t view, const SurfaceSight& sight, const SurfaceSight& reference,
           const Eigen::Vector3d& pivot, double gate_mm) noexcept {
    Member& m = members[count++];
    m.view = view;
    m.height = reference.n_base.dot(sight.p_base - reference.p_base);
    const double s = m.height / gate_mm;
    m.weight = std::max(1e-6, (1.0 - s * s) * (1.0 - s * s));
    arm = reference.p_base - pivot;
    normal = reference.n_base;
    m.b = sight.bowl_mm_per_mm;
    others += count > 1 ? sight.n_base : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }

  [[nodiscard]] Row6 jacobian() const noexcept {
    Row6 j;
    j << normal.transpose(), arm.cross(normal).transpose();
    return j;
  }
};

// The common height is eliminated: what remains are differences to the weighted mean.
void add_group(const Group& group, double weight, std::size_t bowl_at,
               BlockSystem& system) noexcept {
  double sum_w = 0.0;
  double mean = 0.0;
  Eigen::Vector2d mean_b = Eigen::Vector2d::Zero();
  for (std::size_t m = 0; m < group.count; ++m) {
    sum_w += group.members[m].weight;
    mean += group.members[m].weight * group.members[m].height;
    mean_b += group.members[m].weight * group.members[m].b;
  }
  mean /= sum_w;
  mean_b /= sum_w;
  const Row6 j = group.jacobian();
  for (std::size_t m = 0; m < group.count; ++m) {
    const Member& a = group.members[m];
    const double w = weight * a.weight;
    const Eigen::Vector2d b = a.b - mean_b;
    system.add(6 * a.view, 6 * a.view,
               Eigen::Matrix<double, 6, 6>(w * (1.0 - a.weight / sum_w) * j.transpose() * j));
    system.add(6 * a.view, bowl_at, Eigen::Matrix<double, 6, 2>(w * j.transpose() * b.transpose()));
    system.add(bowl_at, bowl_at, Eigen::Matrix2d(w * b * b.transpose()));
    system.add_gradient(6 * a.view, geometry::Vector6(w * (a.height - mean) * j.transpose()));
    system.add_gradient(bowl_at, Eigen::Vector2d(w * (a.height - mean) * b));
    for (std::size_t n = m + 1; n < group.count; ++n) {
      const Member& other = group.members[n];
      system.add(6 * a.view, 6 * other.view,
                 Eigen::Matrix<double, 6, 6>(-w * other.weight / sum_w * j.transpose() * j));
    }
  }
}

// Noise in a normal looks like information along the surface. In the product of two views' normals
// it cancels: n m' + m n' = ((n + m)(n + m)' - (n - m)(n - m)') / 2.
void add_group_without_noise(Group& group, double weight, std::size_t bowl_at,
                             BlockSystem& system) noexcept {
  const Eigen::Vector3d n = group.normal;
  const Eigen::Vector3d m = group.others.normalized();
  group.normal = 0.5 * (n + m);
  add_group(group, weight, bowl_at, system);
  group.normal = 0.5 * (n - m);
  for (Member& member : group.members) {
    member.b.setZero();
  }
  add_group(group, -weight, bowl_at, system);
}

class Walk {
 public:
  Walk(std::span<const PosedView> views, const Eigen::Vector3d& pivot,
       const Eigen::Vector2d& bowl_mm, const SurfaceTieConfig& config, std::size_t bowl_at,
       BlockSystem& system, SurfaceStatistics& statistics) noexcept
      : views_(views),
        pivot_(pivot),
        bowl_mm_(bowl_mm),
        config_(config),
        bowl_at_(bowl_at),
        system_(system),
        statistics_(statistics) {}

  // In tiles, one walked along rows and the next down columns: so residuals are known to hang
  // together both ways.
  std::uint32_t over(std::size_t reference_view) noexcept {
    const PatchField& field = views_[reference_view].field;
    for (std::uint32_t row = 0; row < field.rows; row += kTile) {
      for (std::uint32_t column = 0; column < field.columns; column += kTile) {
        down_ = ((row + column) / kTile) % 2 == 1;
        over_tile(reference_view, column, row);
      }
    }
    return ties_;
  }

 private:
  static constexpr std::uint32_t kTile = 16;  // Patches: long beside what noise has in common.

  void over_tile(std::size_t reference_view, std::uint32_t column, std::uint32_t row) noexcept {
    const PatchField& field = views_[reference_view].field;
    for (std::uint32_t line = 0; line < kTile; ++line) {
      trails_ = {};
      for (std::uint32_t step = 0; step < kTile; ++step) {
        const std::uint32_t i = column + (down_ ? line : step);
        const std::uint32_t j = row + (down_ ? step : line);
        if (i < field.columns && j < field.rows) {
          const Eigen::Vector2d c = field.centre_px(i, j);
          tie(reference_view, sight_at(views_[reference_view], c.x(), c.y(), bowl_mm_));
        }
      }
    }
  }

  // A place that an earlier view sees has been tied from there: nothing is told twice.
  [[nodiscard]] bool is_told(std::size_t reference_view,
                             const SurfaceSight& reference) const noexcept {
    for (std::size_t v = 0; v < reference_view; ++v) {
      const SurfaceSight sight =
          views_[v].used ? sight_of(views_[v], reference, bowl_mm_) : SurfaceSight{};
      const double height = reference.n_base.dot(sight.p_base - reference.p_base);
      if (sight.valid && std::abs(height) < config_.gate_mm) {
        return true;
      }
    }
    return false;
  }

  void tie(std::size_t reference_view, SurfaceSight reference) noexcept {
    reference.valid = reference.valid && !is_told(reference_view, reference);
    const std::size_t facing = facing_of(reference.facing);
    Group group;
    if (reference.valid) {
      group.add(reference_view, reference, reference, pivot_, config_.gate_mm);
    }
    for (std::size_t v = 0; v < views_.size(); ++v) {
      if (v == reference_view || !views_[v].used) {
        continue;
      }
      const SurfaceSight sight =
          reference.valid ? sight_of(views_[v], reference, bowl_mm_) : SurfaceSight{};
      const double height = reference.n_base.dot(sight.p_base - reference.p_base);
      const bool near = sight.valid && std::abs(height) < config_.gate_mm;
      note(reference_view, v, sight.valid, near, height);
      trails_[v].push(height, near, down_, statistics_.by_facing[facing]);
      if (near) {
        group.add(v, sight, reference, pivot_, config_.gate_mm);
      }
    }
    if (group.count >= 2) {
      const double weight = config_.weight * config_.spread[facing];
      if (config_.without_noise) {
        add_group_without_noise(group, weight, bowl_at_, system_);
      } else {
        add_group(group, weight, bowl_at_, system_);
      }
      ties_ += static_cast<std::uint32_t>(group.count - 1);
    }
  }

  void note(std::size_t a, std::size_t b, bool valid, bool near, double height) noexcept {
    if (valid && std::abs(height) < config_.wide_gate_mm) {
      ++statistics_.wide[a];
      ++statistics_.wide[b];
    }
    if (near) {
      ++statistics_.near[a];
      ++statistics_.near[b];
      statistics_.squares[a] += height * height;
      statistics_.squares[b] += height * height;
      ++links_[b];
      if (links_[b] >= kMinTiesOfALink) {
        statistics_.linked[a] = static_cast<cloud::ViewMask>(statistics_.linked[a] | (1U << b));
        statistics_.linked[b] = static_cast<cloud::ViewMask>(statistics_.linked[b] | (1U << a));
      }
    }
  }

  std::span<const PosedView> views_;
  const Eigen::Vector3d& pivot_;
  const Eigen::Vector2d& bowl_mm_;
  const SurfaceTieConfig& config_;
  std::size_t bowl_at_;
  BlockSystem& system_;
  SurfaceStatistics& statistics_;
  std::array<ResidualTrail, cloud::kMaxViews> trails_{};
  std::array<std::uint32_t, cloud::kMaxViews> links_{};
  std::uint32_t ties_ = 0;
  bool down_ = false;
};

}  // namespace

Eigen::Vector2d bowl_shape(const depth::Intrinsics& k, double u, double v) noexcept {
  const double x = (u - k.cx) / (0.5 * k.width);
  const double y = (v - k.cy) / (0.5 * k.height);
  return {x * x, y * y};
}

SurfaceSight sight_at(const PosedView& view, double u, double v,
                      const Eigen::Vector2d& bowl_mm) noexcept {
  const SurfacePoint s = surface_at(view.field, u, v);
  if (!s.valid) {
    return {};
  }
  const Eigen::Vector2d shape = bowl_shape(view.field.intrinsics, u, v);
  const Eigen::Vector3d ray = s.p_camera / s.p_camera.z();
  const Eigen::Vector3d p = s.p_camera - ray * bowl_mm.dot(shape);
  return {true, view.T_base_camera * p, view.T_base_camera.rotation * s.n_camera,
          -s.n_camera.dot(ray) * shape, -s.n_camera.dot(ray.normalized())};
}

SurfaceSight sight_of(const PosedView& view, const SurfaceSight& other,
                      const Eigen::Vector2d& bowl_mm) noexcept {
  const Eigen::Vector3d p = view.T_camera_base * other.p_base;
  if (!(p.z() > 1.0)) {
    return {};
  }
  const depth::Intrinsics& k = view.field.intrinsics;
  SurfaceSight sight =
      sight_at(view, k.fx * p.x() / p.z() + k.cx, k.fy * p.y() / p.z() + k.cy, bowl_mm);
  sight.valid = sight.valid && sight.n_base.dot(other.n_base) > kMinNormalAgreement;
  return sight;
}

TieResiduals SurfaceStatistics::residuals() const noexcept {
  TieResiduals all;
  for (const TieResiduals& facing : by_facing) {
    all.add(facing);
  }
  return all;
}

std::array<double, kFacings> SurfaceStatistics::spread() const noexcept {
  const double of_all = residuals().long_run_mm2();
  std::array<double, kFacings> spread = kEvenSpread;
  for (std::size_t k = 0; k < kFacings && of_all > 0.0; ++k) {
    spread[k] = by_facing[k].long_run_mm2() / of_all;
  }
  return spread;
}

std::uint32_t add_surface_ties(std::span<const PosedView> views, const Eigen::Vector3d& pivot,
                               const Eigen::Vector2d& bowl_mm, const SurfaceTieConfig& config,
                               std::size_t bowl_at, BlockSystem& system,
                               SurfaceStatistics& statistics) noexcept {
  std::uint32_t ties = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (views[v].used) {
      Walk walk(views, pivot, bowl_mm, config, bowl_at, system, statistics);
      ties += walk.over(v);
    }
  }
  return ties;
}

}  // namespace dseam::splice
