// SPDX-License-Identifier: Apache-2.0
#include "support/accuracy/seam_accuracy.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace dseam::test {
namespace {

using Eigen::Vector3d;
using geometry::RigidTransform;
using hal::sim::TruthCurve;
using hal::sim::TruthPoint;

/// Where a view puts a true point.
Vector3d image_of(const ViewPoses& view, const Vector3d& p) {
  return view.adjusted * (view.truth.inverse() * p);
}

std::size_t num_segments(const TruthCurve& curve) {
  return curve.closed ? curve.points.size() : curve.points.size() - 1;
}

struct Foot {
  Vector3d away = Vector3d::Zero();
  double s_mm = 0.0;
  std::size_t sample = 0;
};

Foot foot_on(const TruthCurve& curve, const Vector3d& p) {
  Foot nearest;
  double nearest2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < num_segments(curve); ++i) {
    const TruthPoint& from = curve.points[i];
    const Vector3d along = curve.points[(i + 1) % curve.points.size()].p - from.p;
    const double share = std::clamp((p - from.p).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const Vector3d away = p - from.p - share * along;
    if (away.squaredNorm() < nearest2) {
      nearest2 = away.squaredNorm();
      nearest = {away, from.s_mm + share * along.norm(), i};
    }
  }
  return nearest;
}

PointError error_of(const TruthCurve& curve, const Vector3d& p) {
  const Foot foot = foot_on(curve, p);
  const TruthPoint& at = curve.points[foot.sample];
  Vector3d outwards = at.n_shell.cross(at.tangent).normalized();
  if (outwards.dot(at.n_nozzle) < 0.0) {
    outwards = -outwards;
  }
  return {foot.away.norm(), foot.away.dot(outwards), foot.away.dot(at.n_shell), foot.s_mm};
}

double coverage_of(const TruthCurve& curve, std::span<const Vector3d> measured) {
  constexpr double kReachMm = 1.0;
  std::size_t covered = 0;
  for (const TruthPoint& point : curve.points) {
    covered += std::ranges::any_of(measured, [&](const Vector3d& p) {
      return (p - point.p).squaredNorm() <= kReachMm * kReachMm;
    });
  }
  return static_cast<double>(covered) / static_cast<double>(curve.points.size());
}

SeamAccuracy measure(std::span<const seam::SeamPoint> points, const TruthCurve& truth_base,
                     const RigidTransform& correction, bool measured_only) {
  SeamAccuracy out;
  std::vector<Vector3d> measured;
  std::vector<double> distances;
  double sum2 = 0.0;
  for (const seam::SeamPoint& point : points) {
    const bool is_measured = point.source == seam::Source::kMeasured;
    const Vector3d p = correction * point.p_base;
    if (is_measured) {
      measured.push_back(p);
    }
    if (is_measured || !measured_only) {
      out.points.push_back(error_of(truth_base, p));
      distances.push_back(out.points.back().distance_mm);
      sum2 += distances.back() * distances.back();
    }
  }
  out.coverage = coverage_of(truth_base, measured);
  if (!distances.empty()) {
    out.rmse_mm = std::sqrt(sum2 / static_cast<double>(distances.size()));
    out.max_mm = std::ranges::max(distances);
    out.p95_mm = quantile(std::move(distances), 0.95);
  }
  return out;
}

}  // namespace

RigidTransform base_correction(std::span<const ViewPoses> views, const TruthCurve& truth_base) {
  Vector3d centre_true = Vector3d::Zero();
  Vector3d centre_image = Vector3d::Zero();
  const double count = static_cast<double>(views.size() * truth_base.points.size());
  for (const TruthPoint& point : truth_base.points) {
    for (const ViewPoses& view : views) {
      centre_true += point.p / count;
      centre_image += image_of(view, point.p) / count;
    }
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const TruthPoint& point : truth_base.points) {
    for (const ViewPoses& view : views) {
      spread += (point.p - centre_true) * (image_of(view, point.p) - centre_image).transpose();
    }
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(spread, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d keep_handed = Eigen::Matrix3d::Identity();
  keep_handed(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  RigidTransform correction;
  correction.rotation = svd.matrixU() * keep_handed * svd.matrixV().transpose();
  correction.translation_mm = centre_true - correction.rotation * centre_image;
  return correction;
}

SpliceError splice_error(std::span<const ViewPoses> views, const TruthCurve& truth_base) {
  SpliceError error;
  double sum2 = 0.0;
  for (const TruthPoint& point : truth_base.points) {
    Vector3d mean = Vector3d::Zero();
    for (const ViewPoses& view : views) {
      mean += image_of(view, point.p) / static_cast<double>(views.size());
    }
    double spread2 = 0.0;
    for (const ViewPoses& view : views) {
      spread2 += (image_of(view, point.p) - mean).squaredNorm() / static_cast<double>(views.size());
    }
    sum2 += spread2;
    error.max_mm = std::max(error.max_mm, std::sqrt(spread2));
  }
  error.rms_mm = std::sqrt(sum2 / static_cast<double>(truth_base.points.size()));
  return error;
}

SeamAccuracy measure_seam(std::span<const seam::SeamPoint> points, const TruthCurve& truth_base,
                          const RigidTransform& correction) {
  return measure(points, truth_base, correction, false);
}

SeamAccuracy measure_measured(std::span<const seam::SeamPoint> points, const TruthCurve& truth_base,
                              const RigidTransform& correction) {
  return measure(points, truth_base, correction, true);
}

double pooled_rmse_mm(std::span<const SeamAccuracy> runs) {
  double sum2 = 0.0;
  std::size_t count = 0;
  for (const SeamAccuracy& run : runs) {
    sum2 += run.rmse_mm * run.rmse_mm * static_cast<double>(run.points.size());
    count += run.points.size();
  }
  return count == 0 ? 0.0 : std::sqrt(sum2 / static_cast<double>(count));
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  std::ranges::sort(values);
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - std::floor(place)) * (values[above] - values[below]);
}

}  // namespace dseam::test
