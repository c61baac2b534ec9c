// SPDX-License-Identifier: Apache-2.0
#include "pipe_on_plate.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include "support/data_dir.hpp"

namespace dseam::test {
namespace {

constexpr double kMmPerMetre = 1000.0;

void sample_triangle(const std::array<Eigen::Vector3d, 3>& corners, double spacing_mm,
                     MeshSamples& out) {
  const Eigen::Vector3d a = corners[1] - corners[0];
  const Eigen::Vector3d b = corners[2] - corners[0];
  const Eigen::Vector3d normal = a.cross(b).normalized();
  if (!normal.allFinite()) {
    return;
  }
  const int n = 1 + static_cast<int>(std::max({a.norm(), b.norm(), (a - b).norm()}) / spacing_mm);
  for (int i = 0; i < n; ++i) {
    for (int k = 0; i + k < n; ++k) {
      out.points.add(corners[0] + a * ((i + 1.0 / 3.0) / n) + b * ((k + 1.0 / 3.0) / n));
      out.normals.add(normal);
    }
  }
}

}  // namespace

OwnedCloud measured_scan(const std::string& name) {
  std::ifstream file(data_dir() / "pipe_on_plate" / name);
  OwnedCloud out;
  bool in_data = false;
  for (std::string line; std::getline(file, line);) {
    Eigen::Vector3d p;
    if (in_data && std::sscanf(line.c_str(), "%lf %lf %lf", &p[0], &p[1], &p[2]) == 3) {
      out.add(kMmPerMetre * p);
    }
    in_data = in_data || line.rfind("DATA ascii", 0) == 0;
  }
  return out;
}

MeshSamples mesh_samples(double spacing_mm) {
  constexpr std::size_t kVertices = 2909;
  constexpr std::size_t kFaces = 5816;
  constexpr std::size_t kFaceBytes = 1 + 3 * sizeof(std::int32_t);
  std::ifstream file(data_dir() / "pipe_on_plate" / "shape1.ply", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  const std::size_t header = bytes.find("end_header");
  const std::size_t body = header == std::string::npos ? 0 : bytes.find('\n', header) + 1;
  MeshSamples out;
  if (bytes.size() < body + kVertices * 12 + kFaces * kFaceBytes) {
    return out;
  }
  const char* vertices = bytes.data() + body;
  const char* faces = vertices + kVertices * 12;
  for (std::size_t f = 0; f < kFaces; ++f) {
    std::array<std::int32_t, 3> at{};
    std::memcpy(at.data(), faces + f * kFaceBytes + 1, sizeof(at));
    std::array<Eigen::Vector3d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      Eigen::Vector3f p;
      std::memcpy(p.data(), vertices + static_cast<std::size_t>(at[k]) * 12, 12);
      corners[k] = kMmPerMetre * p.cast<double>();
    }
    sample_triangle(corners, spacing_mm, out);
  }
  return out;
}

}  // namespace dseam::test
