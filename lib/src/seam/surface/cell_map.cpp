// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/surface/cell_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>

namespace dseam::seam {
namespace {

constexpr double kAxisLimit = 1 << 20;
constexpr double kFirstCellMm = 4.0;
constexpr double kSpacingsPerCell = 4.0;
constexpr double kNoisesPerCell = 5.0;
constexpr double kCellsPerArea =
    1.5;  // Cubes that a plane of random direction cuts, per cell area.
constexpr int kMaxPasses = 5;
constexpr double kMinPointsOfPlane = 6.0;
constexpr double kOffPlaneCells = 0.35;
constexpr double kThickCells = 0.15;
constexpr double kOffPlaneNoises = 3.0;
constexpr double kSigmaOfMedian = 1.4826;
constexpr double kToleranceCells = 0.25;
constexpr double kToleranceScatters = 1.5;
constexpr double kMaxSlackRad = 0.35;

bool in_range(const Eigen::Vector3d& scaled) noexcept {
  return (scaled.array().abs() < kAxisLimit).all();  // False for NaN.
}

std::uint64_t mixed(std::int32_t x, std::int32_t y, std::int32_t z) noexcept {
  const auto bits = [](std::int32_t v) { return std::uint64_t{static_cast<std::uint32_t>(v)}; };
  std::uint64_t h = bits(x) * 0x9E3779B97F4A7C15ULL;
  h = (h ^ (h >> 29U) ^ bits(y)) * 0xBF58476D1CE4E5B9ULL;
  h = (h ^ (h >> 32U) ^ bits(z)) * 0x94D049BB133111EBULL;
  return h ^ (h >> 31U);
}

double median_of(std::span<double> values) noexcept {
  if (values.empty()) {
    return 0.0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct PlaneOfMoments {
  Eigen::Vector3d normal;
  double scatter_mm2;
};

PlaneOfMoments plane_of(double n, const Eigen::Vector3d& sum,
                        const Eigen::Matrix3d& square) noexcept {
  const Eigen::Vector3d mean = sum / n;
  const Eigen::Matrix3d covariance = square / n - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const double middle = solver.eigenvalues()[1];
  const double smallest = solver.eigenvalues()[0];
  if (!(middle > 1e-9) || smallest > 0.5 * middle) {
    return {Eigen::Vector3d::Zero(), 0.0};  // A line, or no surface at all.
  }
  return {solver.eigenvectors().col(0), std::max(0.0, smallest) * n / (n - 3.0)};
}

}  // namespace

double CellScale::tolerance_mm() const noexcept {
  return std::max(kToleranceCells * cell_mm, kToleranceScatters * scatter_mm);
}

double CellScale::slack_rad() const noexcept {
  return std::min(kMaxSlackRad, scatter_mm / std::max(cell_mm, 1e-6));
}

CellMap::CellMap(std::size_t max_cells, Arena& arena) noexcept
    : cells_(arena.take<Cell>(max_cells)),
      keys_(arena.take<Key>(max_cells)),
      moments_(arena.take<Moments>(max_cells)),
      slots_(arena.take<std::uint32_t>(std::bit_ceil(2 * max_cells))),
      scratch_(arena.take<double>(max_cells)) {}

CellMap::Report CellMap::run(const cloud::FusedCloudView& in) noexcept {
  Report report;
  report.scale.cell_mm = kFirstCellMm;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    fill(in, report);
    if (report.full) {
      report.scale.cell_mm *= 1.5;
      continue;
    }
    estimate_scales(report);
    const double wanted =
        std::max(kSpacingsPerCell * report.spacing_mm, kNoisesPerCell * report.noise_mm);
    if (report.num_points == 0 ||
        std::abs(wanted - report.scale.cell_mm) < 0.3 * report.scale.cell_mm) {
      break;
    }
    if (pass + 1 < kMaxPasses) {
      report.scale.cell_mm = wanted;
    }
  }
  estimate_normals(report);
  return report;
}

void CellMap::fill(const cloud::FusedCloudView& in, Report& report) noexcept {
  report.num_points = report.num_not_finite = 0;
  report.full = false;
  cells_.clear();
  std::fill(slots_.begin(), slots_.end(), 0U);
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300);
  Eigen::Vector3d high = -low;
  for (std::size_t i = 0; i < in.points.size(); ++i) {
    const Eigen::Vector3d p(in.points.x[i], in.points.y[i], in.points.z[i]);
    if (report.num_points == 0 && p.allFinite()) {
      pivot_ = p;
    }
    const Eigen::Vector3d scaled = (p - pivot_) / report.scale.cell_mm;
    if (!p.allFinite() || !in_range(scaled)) {
      ++report.num_not_finite;
      continue;
    }
    ++report.num_points;
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    const Eigen::Vector3i key = scaled.array().floor().cast<int>();
    if (!add({key.x(), key.y(), key.z()}, p - pivot_,
             in.seen_by.empty() ? cloud::ViewMask{0} : in.seen_by[i])) {
      report.full = true;
      return;
    }
  }
  report.extent_mm = report.num_points == 0 ? 0.0 : (high - low).maxCoeff();
}

bool CellMap::add(const Key& key, const Eigen::Vector3d& p, cloud::ViewMask seen_by) noexcept {
  const std::uint32_t slot = find_slot(key);
  if (slots_[slot] == 0) {
    if (!cells_.append({})) {
      return false;
    }
    const std::size_t index = cells_.size() - 1;
    keys_[index] = key;
    moments_[index] = {};
    slots_[slot] = static_cast<std::uint32_t>(index) + 1;
  }
  const std::size_t index = slots_[slot] - 1;
  Moments& m = moments_[index];
  m.n += 1.0;
  m.sum += p;
  m.square += p * p.transpose();
  cells_[index].seen_by = static_cast<cloud::ViewMask>(cells_[index].seen_by | seen_by);
  return true;
}

// The slot of the key, or the free one where it belongs. The table is at most half full.
std::uint32_t CellMap::find_slot(const Key& key) const noexcept {
  const std::size_t mask = slots_.size() - 1;
  auto i = static_cast<std::size_t>(mixed(key.x, key.y, key.z) & mask);
  while (slots_[i] != 0 && !(keys_[slots_[i] - 1] == key)) {
    i = (i + 1) & mask;
  }
  return static_cast<std::uint32_t>(i);
}

void CellMap::estimate_scales(Report& report) noexcept {
  if (cells_.empty()) {
    return;
  }
  const double mean_count =
      static_cast<double>(report.num_points) / static_cast<double>(cells_.size());
  report.spacing_mm = report.scale.cell_mm / std::sqrt(kCellsPerArea * mean_count);
  std::size_t n = 0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Moments& m = moments_[i];
    const PlaneOfMoments plane = m.n >= kMinPointsOfPlane
                                     ? plane_of(m.n, m.sum, m.square)
                                     : PlaneOfMoments{Eigen::Vector3d::Zero(), 0.0};
    if (plane.normal.squaredNorm() > 0.0) {
      scratch_[n++] = plane.scatter_mm2;
    }
  }
  report.noise_mm = n > 0 ? std::sqrt(median_of(scratch_.first(n))) : report.noise_mm;
}

// A neighbour that lies off the cell's own plane belongs to another surface: the bore behind a
// nozzle's wall. A cell that is thick itself holds two surfaces and has no normal.
void CellMap::estimate_normals(Report& report) noexcept {
  std::size_t scattered = 0;
  const double off_limit =
      kOffPlaneCells * report.scale.cell_mm + kOffPlaneNoises * report.noise_mm;
  const double thick_limit = kThickCells * report.scale.cell_mm + kOffPlaneNoises * report.noise_mm;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Moments& m = moments_[i];
    Cell& cell = cells_[i];
    cell.count = static_cast<std::uint32_t>(m.n);
    cell.mean = pivot_ + m.sum / m.n;
    cell.normal.setZero();
    PlaneOfMoments own{Eigen::Vector3d::Zero(), 0.0};
    if (m.n >= kMinPointsOfPlane) {
      own = plane_of(m.n, m.sum, m.square);
      if (own.normal.squaredNorm() == 0.0 || own.scatter_mm2 > thick_limit * thick_limit) {
        continue;
      }
    }
    const Moments around = around_cell(i, own.normal, off_limit);
    if (around.n < kMinPointsOfPlane) {
      continue;
    }
    cell.normal = plane_of(around.n, around.sum, around.square).normal;
    const double others = around.n - m.n;
    if (others >= kMinPointsOfPlane) {
      scratch_[scattered++] =
          std::abs(cell.normal.dot(m.sum / m.n - (around.sum - m.sum) / others));
    }
  }
  report.scale.scatter_mm = kSigmaOfMedian * median_of(scratch_.first(scattered));
}

// The cell's own sums and those of its neighbours on the same plane; all, where it has no plane.
CellMap::Moments CellMap::around_cell(std::size_t i, const Eigen::Vector3d& normal,
                                      double off_limit_mm) const noexcept {
  const Eigen::Vector3d mean = moments_[i].sum / moments_[i].n;
  Moments around;
  for (std::int32_t k = 0; k < 27; ++k) {
    const Key key{keys_[i].x + k % 3 - 1, keys_[i].y + k / 3 % 3 - 1, keys_[i].z + k / 9 - 1};
    const std::uint32_t found = slots_[find_slot(key)];
    if (found == 0) {
      continue;
    }
    const Moments& m = moments_[found - 1];
    if (std::abs(normal.dot(m.sum / m.n - mean)) <= off_limit_mm) {
      around.n += m.n;
      around.sum += m.sum;
      around.square += m.square;
    }
  }
  return around;
}

}  // namespace dseam::seam
