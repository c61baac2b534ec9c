// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "dseam/hal/replay/scan_set.hpp"

namespace dseam::test {

/// A folder that is gone with the test.
class ScratchFolder {
 public:
  explicit ScratchFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() /
              (name + "_" + std::to_string(reinterpret_cast<std::uintptr_t>(this)))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::filesystem::path operator/(const char* name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// A set of small images whose pixels count up, with camera poses and stamps 100 ms apart.
inline hal::replay::ScanSet small_set(std::uint32_t views) {
  hal::replay::ScanSet set;
  for (std::uint32_t i = 0; i < views; ++i) {
    hal::replay::ScanView view;
    view.camera.id = i;
    view.camera.intrinsics = {16, 12, 40.0, 41.0, 7.5, 5.5};
    view.camera.mm_per_count = 0.1;
    view.camera.T_base_camera = geometry::RigidTransform{
        geometry::rotation_exp({0.1, 0.2 * i, -0.3}), {10.0 * i, -5.0, 600.0}};
    view.camera.stamp_ns = 5'000'000'000 + 100'000'000LL * i;
    for (std::uint32_t pixel = 0; pixel < 16 * 12; ++pixel) {
      view.depth.push_back(static_cast<std::uint16_t>(300 * i + pixel));
      view.gray.push_back(static_cast<std::uint8_t>(i + pixel));
    }
    set.views.push_back(view);
  }
  return set;
}

/// Writes `set` and says whether that worked.
inline bool write_set(const hal::replay::ScanSet& set, const std::filesystem::path& path) {
  auto writer = hal::replay::ScanSetWriter::create(path);
  bool written = writer.ok();
  for (const hal::replay::ScanView& view : set.views) {
    written = written && !writer.value().add(view);
  }
  return written && !writer.value().commit();
}

}  // namespace dseam::test
