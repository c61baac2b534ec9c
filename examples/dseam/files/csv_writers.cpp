// SPDX-License-Identifier: Apache-2.0
#include "files/csv_writers.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <string_view>

namespace dseam::program {
namespace {

constexpr std::size_t kMaxLine = 512;

std::string_view text_of(const std::array<char, kMaxLine>& line, int size) {
  return {line.data(), static_cast<std::size_t>(size)};
}

}  // namespace

double sigma_mm(const seam::SeamPoint& point) noexcept {
  return std::hypot(point.sigma_lateral_mm, point.sigma_normal_mm) / std::sqrt(2.0);
}

const char* name(seam::Confidence confidence) noexcept {
  constexpr std::array kNames{"none", "low", "medium", "high"};
  return kNames[static_cast<std::size_t>(confidence)];
}

const char* name(seam::Source source) noexcept {
  return source == seam::Source::kMeasured ? "measured" : "interpolated";
}

void write_seam_csv(const seam::SeamView& seam_base, std::ostream& out) {
  out << "s_mm,x_mm,y_mm,z_mm,tx,ty,tz,n1x,n1y,n1z,n2x,n2y,n2z,"
         "dihedral_rad,sigma_mm,confidence,source\n";
  std::array<char, kMaxLine> line{};
  for (const seam::SeamPoint& p : seam_base.points) {
    const int size = std::snprintf(
        line.data(), line.size(),
        "%.6f,%.6f,%.6f,%.6f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.6f,%s,%s\n",
        p.s_mm, p.p_base.x(), p.p_base.y(), p.p_base.z(), p.tangent.x(), p.tangent.y(),
        p.tangent.z(), p.n_shell.x(), p.n_shell.y(), p.n_shell.z(), p.n_nozzle.x(), p.n_nozzle.y(),
        p.n_nozzle.z(), p.dihedral_rad, sigma_mm(p), name(p.confidence), name(p.source));
    out << text_of(line, size);
  }
}

void write_path_csv(trajectory::SetPointView set_points, std::ostream& out) {
  out << "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,speed_mm_s,arc,pass\n";
  std::array<char, kMaxLine> line{};
  for (const trajectory::SetPoint& point : set_points) {
    const Eigen::Vector3d& p = point.pose.p_base;
    const Eigen::Quaterniond& q = point.pose.q_base_torch;
    const int size = std::snprintf(line.data(), line.size(),
                                   "%.6f,%.6f,%.6f,%.6f,%.9f,%.9f,%.9f,%.9f,%.6f,%d,%d\n",
                                   1e-6 * point.t_us, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(),
                                   q.z(), point.speed_mm_s, point.arc ? 1 : 0, int{point.pass});
    out << text_of(line, size);
  }
}

}  // namespace dseam::program
