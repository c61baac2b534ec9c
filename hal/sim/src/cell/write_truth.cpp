// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <fstream>
#include <string>

#include "dseam/hal/sim/cell.hpp"

namespace dseam::hal::sim {
namespace {

using seam::ReferenceCurve;

/// A text file under a temporary name until it is whole.
class TextFile {
 public:
  explicit TextFile(std::filesystem::path path)
      : path_(std::move(path)), partial_(path_.string() + ".partial"), out_(partial_) {
    out_.precision(17);
  }
  [[nodiscard]] std::ostream& out() { return out_; }
  [[nodiscard]] bool finish() {
    out_.close();
    std::error_code failed;
    if (!out_.fail()) {
      std::filesystem::rename(partial_, path_, failed);
      return !failed;
    }
    std::filesystem::remove(partial_, failed);
    return false;
  }

 private:
  std::filesystem::path path_;
  std::filesystem::path partial_;
  std::ofstream out_;
};

void write(std::ostream& out, const Eigen::Vector3d& v) {
  out << ',' << v.x() << ',' << v.y() << ',' << v.z();
}

bool write_curve(const TruthCurve& curve, const std::filesystem::path& path) {
  TextFile file(path);
  file.out() << "s_mm,x_mm,y_mm,z_mm,tx,ty,tz,n1x,n1y,n1z,n2x,n2y,n2z,dihedral_rad\n";
  for (const TruthPoint& point : curve.points) {
    file.out() << point.s_mm;
    write(file.out(), point.p);
    write(file.out(), point.tangent);
    write(file.out(), point.n_shell);
    write(file.out(), point.n_nozzle);
    file.out() << ',' << point.dihedral_rad << '\n';
  }
  return file.finish();
}

bool write_markers(const Cell& cell, const std::filesystem::path& path) {
  TextFile file(path);
  file.out() << "marker,x_mm,y_mm,z_mm\n";
  for (std::size_t i = 0; i < cell.markers().size(); ++i) {
    file.out() << i;
    write(file.out(), cell.markers()[i]);
    file.out() << '\n';
  }
  return file.finish();
}

bool write_poses(const Cell& cell, const std::filesystem::path& path) {
  TextFile file(path);
  file.out() << '{';
  for (std::size_t i = 0; i < cell.views().size(); ++i) {
    file.out() << (i == 0 ? "\n" : ",\n") << "  \"" << i << "\": {\"T_base_camera\": [";
    const std::array<double, 16> matrix = geometry::to_row_major(cell.views()[i].T_base_camera);
    for (std::size_t j = 0; j < matrix.size(); ++j) {
      file.out() << (j == 0 ? "" : ", ") << matrix[j];
    }
    file.out() << "]}";
  }
  file.out() << "\n}\n";
  return file.finish();
}

}  // namespace

Result<> write_truth(const Cell& cell, const std::filesystem::path& dir) {
  struct Named {
    ReferenceCurve reference;
    const char* file;
  };
  constexpr std::array<Named, 4> kCurves{
      {{ReferenceCurve::kShellEdge, "truth_seam.csv"},
       {ReferenceCurve::kRoot, "truth_seam_root.csv"},
       {ReferenceCurve::kGapMiddle, "truth_seam_gap_middle.csv"},
       {ReferenceCurve::kNozzleEdge, "truth_seam_nozzle_edge.csv"}}};
  for (const Named& named : kCurves) {
    const auto curve = cell.seam(named.reference);
    if (curve && !write_curve(*curve, dir / named.file)) {
      return Errc::kIo;
    }
  }
  const bool written =
      write_markers(cell, dir / "truth_markers.csv") && write_poses(cell, dir / "truth_poses.json");
  return written ? Result<>() : Errc::kIo;
}

}  // namespace dseam::hal::sim
