// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/surface_start.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace dseam::pipeline {
namespace {

using geometry::RigidTransform;
using seam::SurfaceKind;

constexpr std::size_t kPointsPerCell = 2;

std::size_t num_cells(std::size_t max_points) noexcept {
  return std::max<std::size_t>(1024, max_points / kPointsPerCell);
}

RigidTransform line_frame(const Eigen::Vector3d& point, const Eigen::Vector3d& along,
                          const Eigen::Vector3d& towards_x) noexcept {
  const Eigen::Vector3d z = along.normalized();
  const Eigen::Vector3d x = (towards_x - z * z.dot(towards_x)).normalized();
  RigidTransform frame;
  frame.rotation << x, z.cross(x), z;
  frame.translation_mm = point;
  return frame;
}

}  // namespace

std::size_t SurfaceStart::bytes(std::size_t max_points) noexcept {
  const std::size_t cells = num_cells(max_points);
  return seam::CellMap::bytes(cells) + seam::SurfaceFinder::bytes(cells) +
         2 * (Arena::bytes<Line>(kMaxLines) + Arena::bytes<Eigen::Vector3d>(kMaxSamples)) +
         Arena::bytes<splice::StartCandidate>(kMaxCandidates);
}

Result<SurfaceStart> SurfaceStart::make(const splice::LineSearch::Config& config,
                                        std::size_t max_points, Arena& arena) noexcept {
  if (!(config.tolerance_mm > 0.0) || !(config.spin_step_rad > 1e-3) ||
      !(config.slide_step_mm > 0.0) || max_points == 0) {
    return Errc::kInvalidArgument;
  }
  SurfaceStart start(config);
  start.cells_ = seam::CellMap(num_cells(max_points), arena);
  start.surfaces_ = seam::SurfaceFinder(num_cells(max_points), arena);
  for (Described* described : {&start.target_, &start.source_}) {
    described->lines = Buffer(arena.take<Line>(kMaxLines));
    described->samples = Buffer(arena.take<Eigen::Vector3d>(kMaxSamples));
  }
  start.candidates_ = Buffer(arena.take<splice::StartCandidate>(kMaxCandidates));
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return start;
}

void SurfaceStart::set_target(const cloud::CloudView& target,
                              const search::GridIndex& index) noexcept {
  index_ = &index;
  describe(target, target_);
}

std::span<const splice::StartCandidate> SurfaceStart::run(const cloud::CloudView& source) noexcept {
  candidates_.clear();
  describe(source, source_);
  for (const Line& a : target_.lines.view()) {
    for (const Line& b : source_.lines.view()) {
      // Noise and a short arc may cost a radius a tenth and more.
      constexpr double kSameRadius = 0.2;
      constexpr double kSameCosine = 0.15;
      const bool pipes = a.radius_mm > 0.0 && b.radius_mm > 0.0;
      const bool edges = a.radius_mm == 0.0 && b.radius_mm == 0.0;
      const bool alike = pipes ? std::abs(a.radius_mm - b.radius_mm) < kSameRadius * a.radius_mm
                               : edges && std::abs(a.cosine - b.cosine) < kSameCosine;
      if (alike && index_ != nullptr) {
        search_.run(target_.samples.view(), *index_, source_.samples.view(),
                    {a.T_cloud_line, b.T_cloud_line, pipes}, candidates_);
      }
    }
  }
  return candidates_.view();
}

double SurfaceStart::scale_mm(const cloud::CloudView& cloud) noexcept {
  const seam::CellMap::Report report = cells_.run({cloud, {}, {}});
  return std::max(report.noise_mm, report.spacing_mm);
}

void SurfaceStart::describe(const cloud::CloudView& cloud, Described& out) noexcept {
  out.lines.clear();
  out.samples.clear();
  const seam::CellMap::Report report = cells_.run({cloud, {}, {}});
  out.noise_mm = report.noise_mm;
  out.spacing_mm = report.spacing_mm;
  const auto cells = cells_.cells();
  const std::size_t stride = std::max<std::size_t>(1, (cells.size() - 1) / kMaxSamples + 1);
  for (std::size_t i = 0; i < cells.size(); i += stride) {
    (void)out.samples.append(cells[i].mean);
  }
  surfaces_.run(cells, report.scale);
  const auto found = surfaces_.surfaces();
  for (std::size_t i = 0; i < found.size(); ++i) {
    enter_pipe(found[i], out);
    for (std::size_t k = 0; k < i; ++k) {
      enter_edge(found[i], found[k], out);
      enter_edge(found[k], found[i], out);
    }
  }
}

void SurfaceStart::enter_pipe(const seam::FoundSurface& found, Described& out) const noexcept {
  const seam::Surface& s = found.surface;
  if (s.kind == SurfaceKind::kCylinder || s.kind == SurfaceKind::kCone) {
    enter({line_frame(s.point, s.axis, seam::across(s.axis).u), s.radius_mm, 0.0, found.support},
          out);
  }
}

// Both orders of the two planes: which is which is not known.
void SurfaceStart::enter_edge(const seam::FoundSurface& a, const seam::FoundSurface& b,
                              Described& out) const noexcept {
  constexpr double kParallel = 0.3;  // Sine of 17 degrees.
  if (a.surface.kind != SurfaceKind::kPlane || b.surface.kind != SurfaceKind::kPlane) {
    return;
  }
  const Eigen::Vector3d along = a.surface.axis.cross(b.surface.axis);
  if (along.norm() < kParallel) {
    return;
  }
  Eigen::Matrix3d rows;
  rows << a.surface.axis.transpose(), b.surface.axis.transpose(), along.transpose();
  const Eigen::Vector3d middle = 0.5 * (a.surface.point + b.surface.point);
  const Eigen::Vector3d offsets(a.surface.axis.dot(a.surface.point),
                                b.surface.axis.dot(b.surface.point), along.dot(middle));
  enter({line_frame(rows.inverse() * offsets, along, a.surface.axis), 0.0,
         std::abs(a.surface.axis.dot(b.surface.axis)), std::min(a.support, b.support)},
        out);
}

void SurfaceStart::enter(const Line& line, Described& out) noexcept {
  if (out.lines.full() && line.support <= out.lines[out.lines.size() - 1].support) {
    return;
  }
  if (out.lines.full()) {
    out.lines[out.lines.size() - 1] = line;
  } else {
    (void)out.lines.append(line);
  }
  std::sort(out.lines.items().begin(), out.lines.items().end(),
            [](const Line& a, const Line& b) { return a.support > b.support; });
}

}  // namespace dseam::pipeline
