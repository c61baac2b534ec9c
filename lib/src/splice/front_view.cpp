// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/front_view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dseam/geometry/cylinder_fit.hpp"

namespace dseam::splice {
namespace {

constexpr int kDirections = 300;
constexpr std::size_t kMaxPoints = 6000;
constexpr double kBinScales = 1.4;
constexpr double kHiddenScales = 4.0;  // So far behind, a point is hidden,
constexpr double kBeforeScales = 3.0;  // and so far before, it should have been seen.
constexpr float kEmpty = 1e30F;

Eigen::Vector3d at(const cloud::CloudView& cloud, std::size_t i) noexcept {
  return {static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
          static_cast<double>(cloud.z[i])};
}

std::size_t stride_of(const cloud::CloudView& cloud) noexcept {
  return cloud.size() / kMaxPoints + 1;
}

// Evenly over half the sphere: the other half looks along the same lines.
Eigen::Vector3d direction_of(int i) noexcept {
  constexpr double kGoldenAngle = 2.3999632297286533;
  const double z = (i + 0.5) / kDirections;
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(kGoldenAngle * i), r * std::sin(kGoldenAngle * i), z};
}

}  // namespace

void FrontView::look_along(const Eigen::Vector3d& direction) noexcept {
  direction_ = direction;
  geometry::orthonormal_base(direction, right_, up_);
}

FrontView::Place FrontView::place(const Eigen::Vector3d& p) const noexcept {
  const Eigen::Vector3d d = p - centre_;
  constexpr double kHalf = kSide / 2.0;
  const double column = d.dot(right_) / bin_mm_ + kHalf;
  const double row = d.dot(up_) / bin_mm_ + kHalf;
  const bool inside = column >= 0.0 && row >= 0.0 && column < kSide && row < kSide;
  return {
      inside ? static_cast<std::size_t>(row) * kSide + static_cast<std::size_t>(column) : SIZE_MAX,
      static_cast<float>(d.dot(direction_))};
}

// Returns the share of points that lie in a bin with others far before or behind them.
double FrontView::fill(const cloud::CloudView& cloud) noexcept {
  std::fill(low_.begin(), low_.end(), kEmpty);
  std::fill(high_.begin(), high_.end(), -kEmpty);
  for (std::size_t i = 0; i < cloud.size(); i += stride_of(cloud)) {
    if (const Place at_bin = place(at(cloud, i)); at_bin.bin != SIZE_MAX) {
      low_[at_bin.bin] = std::min(low_[at_bin.bin], at_bin.depth);
      high_[at_bin.bin] = std::max(high_[at_bin.bin], at_bin.depth);
    }
  }
  double hidden = 0.0;
  double asked = 0.0;
  for (std::size_t i = 0; i < cloud.size(); i += stride_of(cloud)) {
    if (const Place p = place(at(cloud, i)); p.bin != SIZE_MAX) {
      hidden += high_[p.bin] - low_[p.bin] > static_cast<float>(kHiddenScales * scale_mm_) ? 1 : 0;
      asked += 1.0;
    }
  }
  return asked > 0.0 ? hidden / asked : 1.0;
}

void FrontView::run(const cloud::CloudView& cloud, double scale_mm) noexcept {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300);
  Eigen::Vector3d high = -low;
  for (std::size_t i = 0; i < cloud.size(); i += stride_of(cloud)) {
    if (const Eigen::Vector3d p = at(cloud, i); p.allFinite()) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  sense_ = 0.0;
  known_ = false;
  if (!(low.array() <= high.array()).all()) {
    return;
  }
  // A thinned cloud is spaced further apart than the whole.
  const double spacing = std::sqrt(static_cast<double>(stride_of(cloud)));
  scale_mm_ = scale_mm;
  centre_ = 0.5 * (low + high);
  bin_mm_ = std::max(kBinScales * scale_mm * spacing, (high - low).norm() / kSide);
  double least = 2.0;
  Eigen::Vector3d best = Eigen::Vector3d::UnitZ();
  for (int i = 0; i < kDirections; ++i) {
    look_along(direction_of(i));
    if (const double hidden = fill(cloud); hidden < least) {
      least = hidden;
      best = direction_;
    }
  }
  look_along(best);
  known_ = fill(cloud) < kMaxHidden;
}

FrontView::Before FrontView::before(const cloud::CloudView& other,
                                    const geometry::RigidTransform& T_this_other) const noexcept {
  Before out;
  double asked = 0.0;
  for (std::size_t i = 0; known_ && i < other.size(); i += stride_of(other)) {
    const Place p = place(T_this_other * at(other, i));
    asked += 1.0;
    if (p.bin != SIZE_MAX && low_[p.bin] < kEmpty) {
      const auto tolerance = static_cast<float>(kBeforeScales * scale_mm_);
      out.plus += p.depth > high_[p.bin] + tolerance ? 1.0 : 0.0;
      out.minus += p.depth < low_[p.bin] - tolerance ? 1.0 : 0.0;
    }
  }
  out.plus /= std::max(asked, 1.0);
  out.minus /= std::max(asked, 1.0);
  return out;
}

double FrontView::contradiction(const Before& before) const noexcept {
  constexpr double kSure = 0.02;
  if (std::abs(sense_) > kSure) {
    return sense_ > 0.0 ? before.plus : before.minus;
  }
  return std::min(before.plus, before.minus);
}

}  // namespace dseam::splice
