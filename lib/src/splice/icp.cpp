// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/icp.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dseam::splice {
namespace {

using geometry::RigidTransform;
using geometry::Vector6;

Eigen::Vector3d at(const cloud::CloudView& c, std::size_t i) noexcept {
  return {static_cast<double>(c.x[i]), static_cast<double>(c.y[i]), static_cast<double>(c.z[i])};
}

Eigen::Vector3d normal_at(const cloud::NormalsView& n, std::size_t i) noexcept {
  return {static_cast<double>(n.nx[i]), static_cast<double>(n.ny[i]), static_cast<double>(n.nz[i])};
}

geometry::Vec3f to_float(const Eigen::Vector3d& p) noexcept {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

Eigen::Vector3d centre_of(const cloud::CloudView& cloud) noexcept {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (const Eigen::Vector3d p = at(cloud, i); p.allFinite()) {
      sum += p;
      count += 1.0;
    }
  }
  return count > 0.0 ? Eigen::Vector3d(sum / count) : sum;
}

RigidTransform moved(const RigidTransform& T, const Vector6& step,
                     const Eigen::Vector3d& pivot) noexcept {
  const Eigen::Matrix3d turn = geometry::rotation_exp(step.tail<3>());
  return {turn * T.rotation, turn * (T.translation_mm - pivot) + pivot + step.head<3>()};
}

}  // namespace

struct Icp::Sums {
  geometry::Matrix6 h = geometry::Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  double weight = 0.0;
  double squares = 0.0;
  double distance_squares = 0.0;
  double reach_squares = 0.0;
  double paired = 0.0;
  double asked = 0.0;

  void add(double residual, const Vector6& j, double w) noexcept {
    h += w * j * j.transpose();
    g += w * residual * j;
    weight += w;
    squares += w * residual * residual;
  }
  [[nodiscard]] double error_mm2() const noexcept {
    return distance_squares / std::max(paired, 1.0);
  }
  [[nodiscard]] double rms_mm() const noexcept {
    return std::sqrt(squares / std::max(weight, 1e-12));
  }
  void describe(Report& report) const noexcept {
    constexpr double kFrozenVariance = 1e6;  // A metre: not known.
    report.error_mm2 = error_mm2();
    report.rms_mm = rms_mm();
    const double variance = std::max(report.rms_mm * report.rms_mm, 1e-12);
    report.covariance =
        report.observability.invert(geometry::Matrix6(h / variance), kFrozenVariance);
  }
};

Icp::Sums Icp::pair_up(const cloud::CloudView& source, const cloud::CloudView& target,
                       const cloud::NormalsView& normals, const search::GridIndex& index,
                       const RigidTransform& T, const Eigen::Vector3d& pivot,
                       double gate_mm) const noexcept {
  Sums sums;
  const bool to_plane = config_.metric == IcpMetric::kPointToPlane;
  for (std::size_t i = 0; i < source.size(); i += std::max<std::uint32_t>(1, config_.stride)) {
    const Eigen::Vector3d p = T * at(source, i);
    if (!p.allFinite()) {
      continue;
    }
    sums.asked += 1.0;
    const search::Neighbour found = index.nearest(to_float(p), static_cast<float>(gate_mm));
    if (found.index == search::kNoPoint) {
      continue;
    }
    const Eigen::Vector3d d = p - at(target, found.index);
    const Eigen::Vector3d n = to_plane ? normal_at(normals, found.index) : Eigen::Vector3d::Zero();
    if (to_plane && n.squaredNorm() < 0.5) {
      continue;
    }
    const Eigen::Vector3d arm = p - pivot;
    const double off = (to_plane ? n.dot(d) : d.norm()) / gate_mm;
    const double w = (1.0 - off * off) * (1.0 - off * off);
    for (int axis = 0; axis < (to_plane ? 1 : 3); ++axis) {
      const Eigen::Vector3d along = to_plane ? n : Eigen::Vector3d(Eigen::Vector3d::Unit(axis));
      Vector6 j;
      j << along, arm.cross(along);
      sums.add(along.dot(d), j, w);
    }
    sums.paired += 1.0;
    sums.distance_squares += d.squaredNorm();
    sums.reach_squares += arm.squaredNorm();
  }
  return sums;
}

Icp::Report Icp::run(const cloud::CloudView& source, const cloud::CloudView& target,
                     const cloud::NormalsView& normals, const search::GridIndex& index,
                     const RigidTransform& start) const noexcept {
  Report report;
  report.T_target_source = start;
  RigidTransform T = start;
  const Eigen::Vector3d pivot = start * centre_of(source);
  double gate = config_.start_gate_mm;
  double last_error = 1e300;
  report.stop = IcpStop::kMaxIterations;
  for (report.iterations = 1; report.iterations <= config_.max_iterations; ++report.iterations) {
    const Sums sums = pair_up(source, target, normals, index, T, pivot, gate);
    report.overlap = sums.paired / std::max(sums.asked, 1.0);
    if (report.overlap < config_.min_overlap || sums.paired < 6.0) {
      report.stop = IcpStop::kNoOverlap;
      return report;
    }
    if (report.iterations == 1) {
      report.observability = find_frozen(sums.h, sums.weight,
                                         std::sqrt(std::max(1.0, sums.reach_squares / sums.paired)),
                                         config_.min_sensitivity);
    }
    sums.describe(report);
    const double next_gate = std::clamp(5.0 * report.rms_mm, config_.final_gate_mm, gate);
    const bool same_gate = next_gate > 0.9 * gate;
    if (config_.metric == IcpMetric::kPointToPoint && report.error_mm2 < config_.stop_error_mm2) {
      report.stop = IcpStop::kBelowThreshold;
      break;
    }
    const double error = config_.metric == IcpMetric::kPointToPoint ? report.error_mm2
                                                                    : report.rms_mm * report.rms_mm;
    if (same_gate && error > (1.0 - config_.stop_fall) * last_error) {
      report.stop = IcpStop::kNoLongerFalls;
      break;
    }
    last_error = same_gate ? error : 1e300;
    T = moved(T, report.observability.solve(sums.h, sums.g), pivot);
    gate = next_gate;
  }
  report.T_target_source = T;
  return report;
}

}  // namespace dseam::splice
