// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/joint/foot_search.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "dseam/geometry/robust.hpp"
#include "dseam/seam/surface/surface_fit.hpp"

namespace dseam::seam {
namespace {

constexpr double kTurnRad = 2.0 * std::numbers::pi;
constexpr double kGolden = 0.6180339887498949;
// Steps that spread three places evenly: powers of 1 / 1.2207, the root of x^4 = x + 1.
constexpr std::array<double, 3> kSpread = {0.8191725134, 0.6710436067, 0.5497004779};
constexpr int kRounds = 4;
constexpr std::size_t kFinalists = 12;
constexpr int kPlaneSteps = 15;
constexpr int kCircleSteps = 20;
constexpr int kWallSteps = 5;

constexpr double kWidestGapMm = 8.0;
constexpr double kClear = 1.5;  // Tolerances from which on what lies off a surface is not of it.
constexpr double kBinCells = 2.0;
constexpr double kFootCells = 2.0;      // So far above the plane no inside of a wall is seen.
constexpr double kBandCells = 5.0;      // So far along the wall and the plane they are fitted.
constexpr double kWallCells = 6.0;      // So far above and below the plane wall is looked for.
constexpr double kTileCosine = 0.6;     // Of a cell's normal and the axis: others are of a wall.
constexpr double kLeanCosine = 0.7;     // Of the plane's and the axis.
constexpr double kSameCosine = 0.65;    // Of a cell's normal and the plane it lies on...
constexpr double kThroughCosine = 0.8;  // ...and one it defines.
constexpr double kLeastTriangle = 0.3;  // Twice its area over the radius squared.
constexpr double kBeyondTolerances = 3.0;
constexpr double kFew = 8.0;  // Points that tell half as much as many.
constexpr std::size_t kBoreSteps = 64;
constexpr int kLeastBore = 40;

std::size_t place_of(std::size_t trial, double step, std::size_t count) noexcept {
  const double part = std::fmod(static_cast<double>(trial + 1) * step, 1.0);
  return std::min(static_cast<std::size_t>(part * static_cast<double>(count)), count - 1);
}

Eigen::Vector3d point_of(const cloud::CloudView& cloud, std::size_t i) noexcept {
  return {cloud.x[i], cloud.y[i], cloud.z[i]};
}

// What speaks at one angle for a plane that a wall stands on, and what against it.
struct Angle {
  double on = 0.0;
  double beyond = 0.0;  // Lies along the plane, but just off it: the sheet is there.
  double above = 0.0;
  double below = 0.0;  // Wall that goes on past the plane.

  [[nodiscard]] double merit() const noexcept {
    const double sheet = (on - beyond) / (on + beyond + kFew);
    return (sheet < 0.0 || above > 0.0 ? sheet : 0.0) - below / (below + kFew);
  }
};

}  // namespace

bool FootSearch::is_worse(const Judged& a, const Judged& b) noexcept { return a.merit < b.merit; }

double FootSearch::clear_mm() const noexcept { return kClear * scale_.tolerance_mm(); }

// The plane tells where the foot is, and the wall at its foot where beside it to look for the
// plane.
std::optional<FootSearch::Found> FootSearch::run(const cloud::CloudView& cloud,
                                                 std::span<const Cell> cells, const Surface& nozzle,
                                                 std::span<const FoundSurface> known,
                                                 const CellScale& scale) noexcept {
  nozzle_ = nozzle;
  nozzle_.kind = SurfaceKind::kCylinder;  // Two sides of a wall taken for one look like a cone.
  nozzle_.slope = 0.0;
  scale_ = scale;
  Judged found;
  for (int round = 0; round < kRounds; ++round) {
    collect(cloud, cells);
    found = best_plane(known);
    if (found.merit == Judged{}.merit) {
      return std::nullopt;
    }
    fit_circle(found.plane);
    if (round > 0) {
      fit_wall(found.plane);
    }
  }
  return Found{{found.plane, nozzle_}, bore_of(cloud, found.plane), found.merit};
}

std::size_t FootSearch::bin_of(const NozzleFrame& frame, const Eigen::Vector3d& p) const noexcept {
  const double turn = angle_about(nozzle_, frame, p) / kTurnRad + 0.5;
  const double bin = std::max(0.0, turn) * static_cast<double>(num_bins_);
  return std::min(static_cast<std::size_t>(bin), num_bins_ - 1);
}

void FootSearch::collect(const cloud::CloudView& cloud, std::span<const Cell> cells) noexcept {
  const NozzleFrame frame = frame_of(nozzle_);
  const double reach_mm = kWidestGapMm + scale_.cell_mm;
  const double band_mm = std::max(reach_mm, kBandCells * scale_.cell_mm);
  num_bins_ = static_cast<std::size_t>(std::clamp(
      kTurnRad * nozzle_.radius_mm / (kBinCells * scale_.cell_mm), 12.0, double{kMaxBins}));
  tiles_.clear();
  for (const Cell& cell : cells) {
    const double outside = signed_distance(nozzle_, cell.mean);
    if (outside > 0.5 * clear_mm() && outside < band_mm &&
        std::abs(cell.normal.dot(nozzle_.axis)) > kTileCosine) {
      (void)tiles_.append({cell.mean, cell.normal, static_cast<double>(cell.count),
                           outside < reach_mm, bin_of(frame, cell.mean)});
    }
  }
  pieces_.clear();
  for (std::size_t k = 0; k < std::min(cloud.size(), kMaxSeen); ++k) {
    const Eigen::Vector3d p = point_of(cloud, place_of(k, kGolden, cloud.size()));
    const double outside = signed_distance(nozzle_, p);
    if (std::abs(outside) < reach_mm) {
      (void)pieces_.append({p, outside, bin_of(frame, p)});
    }
  }
}

// The best of the planes that are known and tried are fitted to what lies on them, and judged
// again.
FootSearch::Judged FootSearch::best_plane(std::span<const FoundSurface> known) const noexcept {
  std::array<Judged, kFinalists> finalists{};
  const auto judge = [&](const Surface& plane) {
    const Judged judged{plane, merit_of(plane)};
    const auto least = std::min_element(finalists.begin(), finalists.end(), is_worse);
    *least = is_worse(*least, judged) ? judged : *least;
  };
  for (const FoundSurface& one : known) {
    const double lean = one.surface.axis.dot(nozzle_.axis);
    if (one.surface.kind == SurfaceKind::kPlane && std::abs(lean) > kLeanCosine) {
      Surface plane = one.surface;
      plane.axis *= std::copysign(1.0, lean);
      judge(plane);
    }
  }
  for (std::size_t trial = 0; trial < kTrials && tiles_.size() >= 3; ++trial) {
    const std::optional<Surface> plane = plane_through(trial);
    if (plane) {
      judge(*plane);
    }
  }
  Judged best;
  for (const Judged& finalist : finalists) {
    if (finalist.merit > Judged{}.merit) {
      const Surface plane = refined(finalist.plane);
      best = std::max({best, Judged{plane, merit_of(plane)}}, is_worse);
    }
  }
  return best;
}

std::optional<Surface> FootSearch::plane_through(std::size_t trial) const noexcept {
  std::array<const Tile*, 3> t{};
  for (std::size_t i = 0; i < t.size(); ++i) {
    t[i] = &tiles_[place_of(trial, kSpread[i], tiles_.size())];
  }
  const Eigen::Vector3d cross = (t[1]->mean - t[0]->mean).cross(t[2]->mean - t[0]->mean);
  const double size = cross.norm();
  if (!(size > kLeastTriangle * nozzle_.radius_mm * nozzle_.radius_mm)) {
    return std::nullopt;
  }
  const double lean = cross.dot(nozzle_.axis) / size;
  const Eigen::Vector3d normal = cross * (std::copysign(1.0, lean) / size);
  const bool through = std::ranges::all_of(t, [&](const Tile* tile) {
    return tile->at_foot && std::abs(tile->normal.dot(normal)) > kThroughCosine;
  });
  return through && std::abs(lean) > kLeanCosine
             ? std::optional(Surface{SurfaceKind::kPlane, t[0]->mean, normal, 0.0, 0.0})
             : std::nullopt;
}

double FootSearch::merit_of(const Surface& plane) const noexcept {
  std::array<Angle, kMaxBins> angles{};
  const double tolerance_mm = scale_.tolerance_mm();
  for (const Tile& tile : tiles_.view()) {
    const double off = std::abs(signed_distance(plane, tile.mean)) / tolerance_mm;
    if (tile.at_foot && off < kBeyondTolerances &&
        std::abs(tile.normal.dot(plane.axis)) > kSameCosine) {
      (off < 1.0 ? angles[tile.bin].on : angles[tile.bin].beyond) += tile.count;
    }
  }
  for (const Piece& piece : pieces_.view()) {
    const double height = signed_distance(plane, piece.place);
    if (std::abs(piece.outside_mm) < clear_mm() && std::abs(height) > tolerance_mm &&
        std::abs(height) < kWallCells * scale_.cell_mm) {
      (height > 0.0 ? angles[piece.bin].above : angles[piece.bin].below) += 1.0;
    }
  }
  double merit = 0.0;
  for (const Angle& angle : angles) {
    merit += angle.merit();
  }
  return merit;
}

Surface FootSearch::refined(Surface plane) const noexcept {
  for (int i = 0; i < kPlaneSteps; ++i) {
    SurfaceEquations equations(plane);
    for (const Tile& tile : tiles_.view()) {
      const double weight = geometry::tukey(signed_distance(plane, tile.mean) / clear_mm());
      if (weight > 0.0 && std::abs(tile.normal.dot(plane.axis)) > kSameCosine) {
        equations.add(tile.mean, tile.count * weight);
      }
    }
    plane = equations.solve().value_or(plane);
  }
  return plane;
}

// The axis is taken as known here: so short a piece of wall does not tell it.
void FootSearch::fit_circle(const Surface& plane) noexcept {
  const AcrossAxis frame = across(nozzle_.axis);
  for (int i = 0; i < kCircleSteps; ++i) {
    Eigen::Matrix3d a = 1e-6 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const Piece& piece : pieces_.view()) {
      const double above = signed_distance(plane, piece.place) - clear_mm();
      const double off = signed_distance(nozzle_, piece.place);
      const double weight = geometry::tukey(off / clear_mm());
      if (above > 0.0 && above < kFootCells * scale_.cell_mm && weight > 0.0) {
        const Eigen::Vector3d outward = outward_normal(nozzle_, piece.place);
        const Eigen::Vector3d row(outward.dot(frame.u), outward.dot(frame.v), 1.0);
        a += weight * row * row.transpose();
        b += weight * off * row;
      }
    }
    const Eigen::Vector3d step = a.ldlt().solve(b);
    nozzle_.point += step.x() * frame.u + step.y() * frame.v;
    nozzle_.radius_mm = std::max(nozzle_.radius_mm + step.z(), scale_.cell_mm);
  }
}

void FootSearch::fit_wall(const Surface& plane) noexcept {
  for (int i = 0; i < kWallSteps; ++i) {
    SurfaceEquations equations(nozzle_);
    for (const Piece& piece : pieces_.view()) {
      const double above = signed_distance(plane, piece.place);
      const double off = signed_distance(nozzle_, piece.place) / scale_.tolerance_mm();
      if (above > clear_mm() && above < kBandCells * scale_.cell_mm) {
        equations.add(piece.place, geometry::tukey(off));
      }
    }
    nozzle_ = equations.solve().value_or(nozzle_);
  }
}

// About the same axis, where most of what lies inside the wall lies.
std::optional<Surface> FootSearch::bore_of(const cloud::CloudView& cloud,
                                           const Surface& plane) const noexcept {
  std::array<int, kBoreSteps> counts{};
  const double step_mm = 0.5 * scale_.tolerance_mm();
  for (std::size_t k = 0; k < std::min(cloud.size(), kMaxSeen); ++k) {
    const Eigen::Vector3d p = point_of(cloud, place_of(k, kGolden, cloud.size()));
    const double inside = -signed_distance(nozzle_, p) / step_mm;
    if (inside > 2.0 && inside < double{kBoreSteps} &&
        signed_distance(plane, p) > scale_.tolerance_mm()) {
      ++counts[static_cast<std::size_t>(inside)];
    }
  }
  std::size_t best = 0;
  int most = kLeastBore;
  for (std::size_t k = 2; k + 1 < kBoreSteps; ++k) {
    const int count = counts[k - 1] + 2 * counts[k] + counts[k + 1];
    best = count > most ? k : best;
    most = std::max(most, count);
  }
  Surface bore = nozzle_;
  bore.radius_mm -= (static_cast<double>(best) + 0.5) * step_mm;
  return best > 0 && bore.radius_mm > 0.0 ? std::optional(bore) : std::nullopt;
}

}  // namespace dseam::seam
