// SPDX-License-Identifier: Apache-2.0
#include "report/loop_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dseam/seam/surface/surface.hpp"

namespace dseam::program {
namespace {

constexpr std::size_t kBins = 120;

/// Angle about the nozzle's axis to arc length along the seam, by a table of the seam's own points.
class AngleToSeam {
 public:
  AngleToSeam(const seam::SeamView& seam_base, const seam::Surface& nozzle)
      : seam_(seam_base), nozzle_(nozzle), frame_(seam::across(nozzle.axis)) {
    for (std::size_t i = 0; i < seam_base.points.size(); ++i) {
      by_angle_.emplace_back(angle_of(seam_base.points[i].p_base), i);
    }
    std::sort(by_angle_.begin(), by_angle_.end());
  }

  [[nodiscard]] const seam::SeamPoint& at(const Eigen::Vector3d& p_base) const {
    const auto after = std::lower_bound(by_angle_.begin(), by_angle_.end(),
                                        std::pair(angle_of(p_base), std::size_t{0}));
    return seam_.points[(after == by_angle_.end() ? by_angle_.front() : *after).second];
  }

 private:
  [[nodiscard]] double angle_of(const Eigen::Vector3d& p_base) const {
    const Eigen::Vector3d from_axis = p_base - nozzle_.point;
    return std::atan2(from_axis.dot(frame_.v), from_axis.dot(frame_.u));
  }

  const seam::SeamView& seam_;
  const seam::Surface& nozzle_;
  seam::AcrossAxis frame_;
  std::vector<std::pair<double, std::size_t>> by_angle_;
};

struct Bin {
  double sum = 0.0;
  double sum_squares = 0.0;
  double count = 0.0;
};

SurfaceProfile profile_of(const std::vector<Bin>& bins, double length_mm) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  SurfaceProfile profile;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const Bin& bin = bins[i];
    const double mean = bin.count >= 3.0 ? bin.sum / bin.count : kNan;
    const double variance = bin.sum_squares / bin.count - mean * mean;
    profile.s_mm.push_back((static_cast<double>(i) + 0.5) * length_mm / kBins);
    profile.mean_mm.push_back(mean);
    profile.spread_mm.push_back(std::sqrt(std::max(0.0, variance)));
  }
  return profile;
}

std::uint8_t surface_of(const Eigen::Vector3d& p, const seam::JointReport& joint,
                        double tolerance_mm) {
  const double to_shell = std::abs(seam::signed_distance(joint.shell, p));
  const double to_nozzle = std::abs(seam::signed_distance(joint.nozzle, p));
  if (std::min(to_shell, to_nozzle) > tolerance_mm) {
    return 2;
  }
  return to_shell <= to_nozzle ? 0 : 1;
}

Eigen::Vector3d point(const cloud::CloudView& cloud, std::size_t i) {
  return {cloud.x[i], cloud.y[i], cloud.z[i]};
}

}  // namespace

std::vector<std::uint8_t> surface_of_points(const cloud::CloudView& cloud_base,
                                            const seam::JointReport& joint, double tolerance_mm) {
  std::vector<std::uint8_t> surfaces(cloud_base.size());
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    surfaces[i] = surface_of(point(cloud_base, i), joint, tolerance_mm);
  }
  return surfaces;
}

LoopProfile loop_profile(const cloud::CloudView& cloud_base, const seam::SeamView& seam_base,
                         const seam::JointReport& joint, double reach_mm) {
  std::vector<Bin> bins[2] = {std::vector<Bin>(kBins), std::vector<Bin>(kBins)};
  const AngleToSeam seam_at(seam_base, joint.nozzle);
  for (std::size_t i = 0; i < cloud_base.size() && !seam_base.points.empty(); ++i) {
    const Eigen::Vector3d p = point(cloud_base, i);
    const seam::SeamPoint& near = seam_at.at(p);
    const std::uint8_t surface = surface_of(p, joint, 1.0);
    if (surface > 1 || (p - near.p_base).norm() > reach_mm) {
      continue;
    }
    const double residual = seam::signed_distance(surface == 0 ? joint.shell : joint.nozzle, p);
    const auto place = static_cast<std::size_t>(near.s_mm / seam_base.length_mm * kBins);
    Bin& bin = bins[surface][std::min(place, kBins - 1)];
    bin.sum += residual;
    bin.sum_squares += residual * residual;
    bin.count += 1.0;
  }
  return {profile_of(bins[0], seam_base.length_mm), profile_of(bins[1], seam_base.length_mm)};
}

}  // namespace dseam::program
