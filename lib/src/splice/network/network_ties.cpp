// SPDX-License-Identifier: Apache-2.0
#include "splice/network/network_ties.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace dseam::splice {
namespace {

using Matrix36 = Eigen::Matrix<double, 3, 6>;
using Matrix32 = Eigen::Matrix<double, 3, 2>;

struct Sight {
  std::size_t view = 0;
  Eigen::Vector3d q = Eigen::Vector3d::Zero();
  Eigen::Matrix3d weight = Eigen::Matrix3d::Zero();
  Matrix32 b = Matrix32::Zero();

  [[nodiscard]] Matrix36 jacobian(const Eigen::Vector3d& pivot) const noexcept {
    Matrix36 j;
    j << Eigen::Matrix3d::Identity(), -geometry::skew(q - pivot);
    return j;
  }
};

Sight placed_sight(const PosedView& view, const MarkerSight& sight,
                   const Eigen::Vector2d& bowl_mm) noexcept {
  Sight out;
  out.view = sight.view;
  const depth::Intrinsics& k = view.field.intrinsics;
  const Eigen::Vector3d ray = sight.p_camera / sight.p_camera.z();
  const Eigen::Vector2d shape = bowl_shape(k, k.fx * ray.x() + k.cx, k.fy * ray.y() + k.cy);
  const Eigen::Matrix3d& r = view.T_base_camera.rotation;
  out.q = view.T_base_camera * (sight.p_camera - ray * bowl_mm.dot(shape));
  out.weight = (r * sight.covariance_mm2 * r.transpose()).inverse();
  out.b = -(r * ray) * shape.transpose();
  return out;
}

struct Landmark {
  std::array<Sight, cloud::kMaxViews> sights;
  std::size_t count = 0;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  Matrix32 mean_b = Matrix32::Zero();

  void settle() noexcept {
    sum.setZero();
    Eigen::Vector3d q = Eigen::Vector3d::Zero();
    Matrix32 b = Matrix32::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      sum += sights[i].weight;
      q += sights[i].weight * sights[i].q;
      b += sights[i].weight * sights[i].b;
    }
    place = sum.inverse() * q;
    mean_b = sum.inverse() * b;
  }
  // Sights far from where the others have the landmark lose their weight; two rounds.
  std::uint32_t down_weight() noexcept {
    constexpr double kFair = 16.0;
    constexpr double kWrong = 100.0;
    std::uint32_t wrong = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d d = sights[i].q - place;
      const double chi_squared = d.dot(sights[i].weight * d);
      wrong += chi_squared > kWrong ? 1U : 0U;
      sights[i].weight *= chi_squared > kFair ? kFair / chi_squared : 1.0;
    }
    settle();
    return wrong;
  }
};

// Not inlined: its blocks and the landmark would share one large stack frame.
[[gnu::noinline]] void add_landmark(const Landmark& landmark, const Eigen::Vector3d& pivot,
                                    std::size_t bowl_at, BlockSystem& system) noexcept {
  const Eigen::Matrix3d inverse_sum = landmark.sum.inverse();
  for (std::size_t m = 0; m < landmark.count; ++m) {
    const Sight& a = landmark.sights[m];
    const Matrix36 j = a.jacobian(pivot);
    const Eigen::Matrix<double, 6, 3> jw = j.transpose() * a.weight;
    const Matrix32 b = a.b - landmark.mean_b;
    const Eigen::Vector3d d = a.q - landmark.place;
    system.add(6 * a.view, 6 * a.view,
               geometry::Matrix6(jw * j - jw * inverse_sum * jw.transpose()));
    system.add(6 * a.view, bowl_at, Eigen::Matrix<double, 6, 2>(jw * b));
    system.add(bowl_at, bowl_at, Eigen::Matrix2d(b.transpose() * a.weight * b));
    system.add_gradient(6 * a.view, geometry::Vector6(jw * d));
    system.add_gradient(bowl_at, Eigen::Vector2d(b.transpose() * a.weight * d));
    for (std::size_t n = m + 1; n < landmark.count; ++n) {
      const Sight& other = landmark.sights[n];
      system.add(6 * a.view, 6 * other.view,
                 geometry::Matrix6(-jw * inverse_sum * other.weight * other.jacobian(pivot)));
    }
  }
}

void note(const Landmark& landmark, MarkerStatistics& statistics) noexcept {
  ++statistics.landmarks;
  statistics.freedom += 3.0 * static_cast<double>(landmark.count - 1);
  cloud::ViewMask seen = 0;
  for (std::size_t i = 0; i < landmark.count; ++i) {
    seen = static_cast<cloud::ViewMask>(seen | (1U << landmark.sights[i].view));
  }
  for (std::size_t i = 0; i < landmark.count; ++i) {
    const std::size_t v = landmark.sights[i].view;
    const Eigen::Vector3d d = landmark.sights[i].q - landmark.place;
    statistics.chi_squared += d.dot(landmark.sights[i].weight * d);
    statistics.squares[v] += d.squaredNorm();
    ++statistics.count[v];
    statistics.linked[v] = static_cast<cloud::ViewMask>(statistics.linked[v] | seen);
  }
}

}  // namespace

void add_marker_ties(std::span<const PosedView> views, std::span<const MarkerSight> sights,
                     const Eigen::Vector3d& pivot, const Eigen::Vector2d& bowl_mm,
                     double variance_factor, std::size_t bowl_at, BlockSystem& system,
                     MarkerStatistics& statistics) noexcept {
  std::size_t i = 0;
  while (i < sights.size()) {
    Landmark landmark;
    const std::uint16_t id = sights[i].landmark;
    for (; i < sights.size() && sights[i].landmark == id; ++i) {
      const MarkerSight& s = sights[i];
      if (s.view < views.size() && views[s.view].used && landmark.count < cloud::kMaxViews &&
          s.p_camera.z() > 0.0) {
        landmark.sights[landmark.count] = placed_sight(views[s.view], s, bowl_mm);
        landmark.sights[landmark.count++].weight /= variance_factor;
      }
    }
    if (landmark.count >= 2) {
      landmark.settle();
      statistics.rejected += landmark.down_weight();
      add_landmark(landmark, pivot, bowl_at, system);
      note(landmark, statistics);
    }
  }
}

ReportedResidual reported_residual(const geometry::RigidTransform& T_base_camera,
                                   const geometry::RigidTransform& reported,
                                   const ViewNetwork::Config& config) noexcept {
  ReportedResidual out;
  out.value.head<3>() = T_base_camera.translation_mm - reported.translation_mm;
  out.value.tail<3>() =
      geometry::rotation_log(T_base_camera.rotation * reported.rotation.transpose());
  out.chi_squared =
      out.value.head<3>().squaredNorm() / (config.reported_sigma_mm * config.reported_sigma_mm) +
      out.value.tail<3>().squaredNorm() / (config.reported_sigma_rad * config.reported_sigma_rad);
  return out;
}

void add_reported_tie(const geometry::RigidTransform& T_base_camera,
                      const geometry::RigidTransform& reported, const Eigen::Vector3d& pivot,
                      const ViewNetwork::Config& config, std::size_t at,
                      BlockSystem& system) noexcept {
  const ReportedResidual r = reported_residual(T_base_camera, reported, config);
  const double excess = std::max(1.0, r.chi_squared / kReportedChiSquaredLimit);
  geometry::Vector6 w;
  w << Eigen::Vector3d::Constant(1.0 / (config.reported_sigma_mm * config.reported_sigma_mm)),
      Eigen::Vector3d::Constant(1.0 / (config.reported_sigma_rad * config.reported_sigma_rad));
  w /= excess * excess;
  geometry::Matrix6 j = geometry::Matrix6::Identity();
  j.topRightCorner<3, 3>() = -geometry::skew(T_base_camera.translation_mm - pivot);
  system.add(at, at, geometry::Matrix6(j.transpose() * w.asDiagonal() * j));
  system.add_gradient(at, geometry::Vector6(j.transpose() * w.asDiagonal() * r.value));
}

}  // namespace dseam::splice
