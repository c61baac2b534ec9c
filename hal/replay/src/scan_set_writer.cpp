// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "dseam/hal/replay/png.hpp"
#include "dseam/hal/replay/scan_set.hpp"
#include "image_name.hpp"

namespace dseam::hal::replay {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::vector<double> row_major(const Eigen::Matrix3d& m) {
  std::vector<double> out;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      out.push_back(m(row, column));
    }
  }
  return out;
}

Json json_of(const ViewCamera& camera) {
  const depth::Intrinsics& k = camera.intrinsics;
  Json view;
  view["cam_K"] = {k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0};
  view["depth_scale"] = camera.mm_per_count;
  if (camera.T_base_camera) {
    const geometry::RigidTransform T_camera_base = camera.T_base_camera->inverse();
    const Eigen::Vector3d& t = T_camera_base.translation_mm;
    view["cam_R_w2c"] = row_major(T_camera_base.rotation);
    view["cam_t_w2c"] = {t.x(), t.y(), t.z()};
  }
  if (camera.T_base_flange) {
    view["T_base_flange"] = geometry::to_row_major(*camera.T_base_flange);
  }
  if (camera.stamp_ns) {
    view["stamp_ns"] = *camera.stamp_ns;
  }
  return view;
}

LoadFault fault_of(const fs::path& path, const std::string& text) {
  return {path.string() + ": " + text};
}

}  // namespace

Loaded<ScanSetWriter> ScanSetWriter::create(const fs::path& named) {
  const fs::path set = named.has_filename() ? named : named.parent_path();  // "SET/" is SET.
  std::error_code error;
  if (fs::exists(set, error)) {
    return fault_of(set, "exists already");
  }
  const fs::path partial = set.string() + ".partial";
  fs::remove_all(partial, error);
  fs::create_directories(partial / "depth", error);
  if (error) {
    return fault_of(set, "cannot be made: " + error.message());
  }
  return ScanSetWriter(set, partial);
}

ScanSetWriter::ScanSetWriter(fs::path set, fs::path partial)
    : set_(std::move(set)), partial_(std::move(partial)) {}

ScanSetWriter::ScanSetWriter(ScanSetWriter&& other) noexcept
    : set_(std::move(other.set_)),
      partial_(std::exchange(other.partial_, {})),
      cameras_(std::move(other.cameras_)) {}

ScanSetWriter::~ScanSetWriter() {
  if (!partial_.empty()) {
    std::error_code ignored;
    fs::remove_all(partial_, ignored);
  }
}

std::optional<LoadFault> ScanSetWriter::add(const ScanView& view) {
  const depth::Intrinsics& k = view.camera.intrinsics;
  const std::size_t pixels = std::size_t{k.width} * k.height;
  const bool gray_fits = view.gray.empty() || view.gray.size() == pixels;
  if (pixels == 0 || view.depth.size() != pixels || !gray_fits) {
    return fault_of(set_, "images and camera differ in size");
  }
  const fs::path depth_file = partial_ / "depth" / image_name(view.camera.id);
  if (const auto fault = write_png16(depth_file, k.width, k.height, view.depth)) {
    return fault_of(depth_file, fault->text);
  }
  if (!view.gray.empty()) {
    std::error_code ignored;  // Writing into it says what is wrong.
    fs::create_directories(partial_ / "gray", ignored);
    const fs::path gray_file = partial_ / "gray" / image_name(view.camera.id);
    if (const auto fault = write_png8(gray_file, k.width, k.height, view.gray)) {
      return fault_of(gray_file, fault->text);
    }
  }
  cameras_.push_back(view.camera);
  return std::nullopt;
}

std::optional<LoadFault> ScanSetWriter::commit() {
  Json root = Json::object();
  for (const ViewCamera& camera : cameras_) {
    root[std::to_string(camera.id)] = json_of(camera);
  }
  std::ofstream out(partial_ / "scene_camera.json");
  out << root.dump(1) << '\n';
  out.close();
  if (out.fail()) {
    return fault_of(partial_ / "scene_camera.json", "cannot be written");
  }
  std::error_code error;
  fs::rename(partial_, set_, error);
  if (error) {
    return fault_of(set_, "cannot be made: " + error.message());
  }
  partial_.clear();
  return std::nullopt;
}

}  // namespace dseam::hal::replay
