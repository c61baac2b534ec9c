// SPDX-License-Identifier: Apache-2.0
#include "scanner/blind_zone.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dseam::hal::sim {
namespace {

using Eigen::Array3i;
using Eigen::Vector3d;

}  // namespace

BlindZone::BlindZone(const Blind& blind) : blind_(blind) {
  const double reach_unseen = blind.unseen_length_mm > 0.0 ? blind.unseen_reach_mm : 0.0;
  reach_mm_ = std::max(0.5 * blind.dead_band_mm, reach_unseen);
  if (reach_mm_ > 0.0 && !blind.joint_part.points.empty()) {
    fill_cells();
  }
}

void BlindZone::fill_cells() {
  const std::vector<TruthPoint>& points = blind_.joint_part.points;
  Vector3d low = points.front().p;
  Vector3d high = low;
  for (const TruthPoint& point : points) {
    low = low.cwiseMin(point.p);
    high = high.cwiseMax(point.p);
  }
  corner_ = low.array() - reach_mm_ - kCellMm;
  size_ = (((high - corner_).array() + reach_mm_ + kCellMm) / kCellMm).ceil().cast<int>() + 1;
  cells_.resize(static_cast<std::size_t>(size_.prod()));
  const int around = static_cast<int>(std::ceil((reach_mm_ + 1.0) / kCellMm));
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Array3i middle = cell_of(points[i].p);
    const Array3i first = (middle - around).max(0);
    const Array3i last = (middle + around).min(size_ - 1);
    for (int z = first.z(); z <= last.z(); ++z) {
      for (int y = first.y(); y <= last.y(); ++y) {
        for (int x = first.x(); x <= last.x(); ++x) {
          cells_[index_of({x, y, z})].push_back(i);
        }
      }
    }
  }
}

Array3i BlindZone::cell_of(const Vector3d& p) const noexcept {
  return ((p - corner_).array() / kCellMm).floor().cast<int>();
}

std::size_t BlindZone::index_of(const Array3i& cell) const noexcept {
  return static_cast<std::size_t>((cell.z() * size_.y() + cell.y()) * size_.x() + cell.x());
}

bool BlindZone::is_unseen(double s_mm) const noexcept {
  const double length = blind_.joint_part.length_mm;
  const double along = std::fmod(s_mm - blind_.unseen_from_mm + length, length);
  return along < blind_.unseen_length_mm;
}

double BlindZone::squared_distance(const Vector3d& p, std::size_t i) const noexcept {
  const TruthPoint& point = blind_.joint_part.points[i];
  const Vector3d away = p - point.p;
  const double along = std::clamp(away.dot(point.tangent), -0.25, 0.25);
  return (away - along * point.tangent).squaredNorm();
}

bool BlindZone::covers(const Vector3d& p) const noexcept {
  if (cells_.empty()) {
    return false;
  }
  const Array3i cell = cell_of(p);
  if ((cell < 0).any() || (cell >= size_).any()) {
    return false;
  }
  double nearest2 = std::numeric_limits<double>::infinity();
  std::uint32_t nearest = 0;
  for (const std::uint32_t i : cells_[index_of(cell)]) {
    const double distance2 = squared_distance(p, i);
    if (distance2 < nearest2) {
      nearest2 = distance2;
      nearest = i;
    }
  }
  const double half_band = 0.5 * blind_.dead_band_mm;
  const double reach = blind_.unseen_reach_mm;
  return nearest2 < half_band * half_band ||
         (blind_.unseen_length_mm > 0.0 && nearest2 < reach * reach &&
          is_unseen(blind_.joint_part.points[nearest].s_mm));
}

}  // namespace dseam::hal::sim
