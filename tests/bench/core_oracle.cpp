// SPDX-License-Identifier: Apache-2.0
// PCL as a second oracle: how far the answers of the core agree with it, stage by stage. Ends with
// 1 where one agrees less than is asked.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <string>

#include "core_chain.hpp"
#include "part_cloud.hpp"
#include "pcl_peer.hpp"
#include "support/data_dir.hpp"

namespace dseam::bench {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

// What is asked.
constexpr double kLeastKeptAlike = 0.9999;
constexpr float kWorstCentroidMm = 1.0e-3F;
constexpr double kWorstNormalDeg = 0.01;
constexpr double kLeastFlagsAlike = 0.999;

int num_misses = 0;

void expect(bool met, const char *name, const char *what) {
  if (!met) {
    ++num_misses;
    std::printf("%s: MISSED: %s\n", name, what);
  }
}

void compare_outliers(const char *name, const test::OwnedCloud &cloud, const CoreChain &core) {
  PclPeer pcl(cloud.x, cloud.y, cloud.z);
  pcl.passthrough(kLowZ, kHighZ);
  pcl.use_cropped();
  pcl.remove_outliers(5, 1.0);
  const std::vector<int> theirs = pcl.kept();
  const std::set<int> their_set(theirs.begin(), theirs.end());
  std::size_t both = 0;
  for (const std::uint32_t i : core.kept.view()) {
    both += their_set.count(static_cast<int>(i));
  }
  const std::size_t kept_by_one = theirs.size() + core.kept.size() - 2 * both;
  const double alike =
      1.0 - static_cast<double>(kept_by_one) / static_cast<double>(core.cropped.size());
  std::printf("%s: outliers kept alike %.4f %% (%zu, %zu)\n", name, 100.0 * alike, core.kept.size(),
              theirs.size());
  expect(alike >= kLeastKeptAlike, name, "outliers kept alike");
}

void compare_cells(const char *name, const CoreChain &core, float cell_mm) {
  PclPeer cells(core.cleaned.view().x, core.cleaned.view().y, core.cleaned.view().z);
  cells.downsample(cell_mm);
  std::vector<std::array<float, 3>> a;
  std::vector<std::array<float, 3>> b;
  const std::vector<float> xyz = cells.cells_xyz();
  for (std::size_t i = 0; i < core.cells.size(); ++i) {
    a.push_back({core.cells[i].x, core.cells[i].y, core.cells[i].z});
  }
  for (std::size_t i = 0; i < xyz.size(); i += 3) {
    b.push_back({xyz[i], xyz[i + 1], xyz[i + 2]});
  }
  const auto by_cell = [cell_mm](const auto &p, const auto &q) {
    for (const std::size_t axis : {2U, 1U, 0U}) {
      const float pc = std::floor(p[axis] / cell_mm);
      const float qc = std::floor(q[axis] / cell_mm);
      if (pc != qc) {
        return pc < qc;
      }
    }
    return p < q;
  };
  std::sort(a.begin(), a.end(), by_cell);
  std::sort(b.begin(), b.end(), by_cell);
  float worst = a.size() == b.size() ? 0.0F : INFINITY;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    for (const std::size_t axis : {0U, 1U, 2U}) {
      worst = std::max(worst, std::fabs(a[i][axis] - b[i][axis]));
    }
  }
  std::printf("%s: cells %zu and %zu, centroids differ by at most %.6f mm\n", name, a.size(),
              b.size(), static_cast<double>(worst));
  expect(worst <= kWorstCentroidMm, name, "centroids");
}

double angle_deg(const Eigen::Vector3d &truth, geometry::Vec3f n) {
  return std::asin(std::min(1.0, truth.cross(Eigen::Vector3d(n.x, n.y, n.z)).norm())) * kDegPerRad;
}

/// Where the two differ: whether ours is that of the covariance in double, about the point itself.
bool is_ours_right(const CoreChain &core, std::size_t i, float radius_mm, geometry::Vec3f theirs) {
  const cloud::CloudView view = core.cells.view();
  const auto at = [&](std::size_t j) { return Eigen::Vector3d(view.x[j], view.y[j], view.z[j]); };
  const float squared_mm2 = radius_mm * radius_mm;
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (std::size_t j = 0; j < view.size(); ++j) {
    if (geometry::squared_norm(view[j] - view[i]) <= squared_mm2) {
      const Eigen::Vector3d off = at(j) - at(i);
      moment += off * off.transpose();
      sum += off;
      count += 1.0;
    }
  }
  const Eigen::Matrix3d covariance = moment / count - sum * sum.transpose() / (count * count);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d truth = solver.eigenvectors().col(0);
  const double ours_deg = angle_deg(truth, core.normal_buffer[i]);
  std::printf(
      "  %.0f neighbours, eigenvalues %.4f %.4f %.4f; from the normal in double ours is %.4f "
      "degree off, PCL's %.4f\n",
      count, solver.eigenvalues()[0], solver.eigenvalues()[1], solver.eigenvalues()[2], ours_deg,
      angle_deg(truth, theirs));
  return ours_deg <= kWorstNormalDeg;
}

void compare_normals(const char *name, const CoreChain &core, float radius_mm) {
  const cloud::CloudView view = core.cells.view();
  PclPeer peer(view.x, view.y, view.z);
  peer.estimate_normals(radius_mm);
  peer.find_boundary(radius_mm, kGapRad);
  const std::vector<float> normals = peer.normals_xyz();
  const std::vector<std::uint8_t> flags = peer.boundary();
  double worst_deg = 0.0;
  std::size_t good = 0;
  std::size_t flags_alike = 0;
  for (std::size_t i = 0; i < core.cells.size(); ++i) {
    if (core.normal_buffer.state[i] == cloud::NormalState::kGood) {
      ++good;
      flags_alike += (core.boundary_buffer.gap_rad[i] > kGapRad) == (flags[i] != 0) ? 1U : 0U;
      const geometry::Vec3f theirs{normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]};
      const geometry::Vec3f turned = geometry::cross(core.normal_buffer[i], theirs);
      const double deg =
          std::asin(std::min(1.0, static_cast<double>(geometry::norm(turned)))) * kDegPerRad;
      worst_deg = std::max(worst_deg, deg);
      if (deg > kWorstNormalDeg) {
        std::printf("%s: normal %zu is %.4f degree off\n", name, i, deg);
        expect(is_ours_right(core, i, radius_mm, theirs), name, "a normal");
      }
    }
  }
  const double alike = static_cast<double>(flags_alike) / static_cast<double>(good);
  std::printf("%s: %zu normals, worst %.4f degree; boundary flags alike %.4f %%\n", name, good,
              worst_deg, 100.0 * alike);
  expect(good > 0 && alike >= kLeastFlagsAlike, name, "boundary flags");
}

/// Both run over the same cells, so that each stage is compared by itself.
void compare(const char *name, const test::OwnedCloud &cloud, float cell_mm, float radius_mm) {
  CoreChain core(cloud, cell_mm, radius_mm);
  core.crop();  // Its list was written over by the later stages.
  core.clean();
  compare_outliers(name, cloud, core);
  compare_cells(name, core, cell_mm);
  compare_normals(name, core, radius_mm);
}

/// A measured scan: points in metres behind the last line of a header.
test::OwnedCloud measured_scan(const std::filesystem::path &path) {
  test::OwnedCloud cloud;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line) && line != "DATA ascii";) {
  }
  for (float x, y, z; file >> x >> y >> z;) {
    cloud.add(x * 1000.0F, y * 1000.0F, z * 1000.0F);
  }
  return cloud;
}

/// Each is noisier than it is dense: 3,000 points, 1.4 mm.
void compare_measured() {
  for (const char *name : {"shape1_0deg_filtered", "shape1_45deg_filtered_aligned",
                           "shape1_60deg_filtered", "shape1_90deg_filtered"}) {
    const auto path = test::data_dir() / "pipe_on_plate" / (std::string(name) + ".pcd");
    if (std::filesystem::exists(path)) {
      const test::OwnedCloud cloud = measured_scan(path);
      compare(name, cloud, 4.0F, 12.0F);
    } else {
      std::printf("%s: no measured data at %s\n", name, path.c_str());
    }
  }
}

}  // namespace
}  // namespace dseam::bench

int main() {
  using namespace dseam;
  bench::compare("part, 120,887 points, 3 mm", bench::part_cloud(120887), 3.0F, 7.5F);
  bench::compare("part, 120,887 points, 1 mm", bench::part_cloud(120887), 1.0F, 2.5F);
  bench::compare("part, 1,000,000 points, 1 mm", bench::part_cloud(1000000), 1.0F, 2.5F);
  bench::compare_measured();
  return bench::num_misses == 0 ? 0 : 1;
}
