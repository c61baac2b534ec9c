// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "dseam/hal/replay/png.hpp"
#include "dseam/hal/replay/scan_set.hpp"
#include "image_name.hpp"

namespace dseam::hal::replay {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& text) {
  throw std::runtime_error(file.string() + ": " + text);
}

std::string read_bytes(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || fs::is_directory(file)) {
    refuse(file, fs::exists(file) ? "cannot be read" : "is missing");
  }
  std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (in.bad()) {
    refuse(file, "cannot be read to its end");
  }
  return bytes;
}

template <typename Image>
Image image_in(const fs::path& file, Loaded<Image> (*parse)(std::span<const std::byte>)) {
  const std::string bytes = read_bytes(file);
  Loaded<Image> image = parse(std::as_bytes(std::span(bytes)));
  if (!image.ok()) {
    refuse(file, image.fault());
  }
  return std::move(image.value());
}

ScanView read_view(const fs::path& set, const ViewCamera& camera) {
  ScanView view{camera, {}, {}};
  auto depth = image_in(set / "depth" / image_name(camera.id), parse_png16);
  view.camera.intrinsics.width = depth.width;
  view.camera.intrinsics.height = depth.height;
  view.depth = std::move(depth.pixels);
  if (!fs::exists(set / "gray")) {
    return view;
  }
  const fs::path gray_file = set / "gray" / image_name(camera.id);
  auto gray = image_in(gray_file, parse_png8);
  if (gray.width != depth.width || gray.height != depth.height) {
    refuse(gray_file, "is " + std::to_string(gray.width) + " x " + std::to_string(gray.height) +
                          " pixels, its depth image " + std::to_string(depth.width) + " x " +
                          std::to_string(depth.height));
  }
  view.gray = std::move(gray.pixels);
  return view;
}

ScanSet read_all(const fs::path& set) {
  if (!fs::is_directory(set)) {
    refuse(set, "is not a folder");
  }
  const fs::path index = set / "scene_camera.json";
  auto cameras = parse_scene_camera(read_bytes(index), index);
  if (!cameras.ok()) {
    throw std::runtime_error(cameras.fault());
  }
  ScanSet out;
  for (const ViewCamera& camera : cameras.value()) {
    out.views.push_back(read_view(set, camera));
  }
  return out;
}

}  // namespace

Loaded<ScanSet> read_scan_set(const fs::path& set) {
  try {
    return read_all(set);
  } catch (const std::bad_alloc&) {
    return LoadFault{set.string() + ": is too large for this machine's memory"};
  } catch (const std::exception& error) {
    return LoadFault{error.what()};
  }
}

}  // namespace dseam::hal::replay
