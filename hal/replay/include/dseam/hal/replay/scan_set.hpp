// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "dseam/depth/depth_image.hpp"
#include "dseam/geometry/rigid_transform.hpp"
#include "dseam/hal/replay/loaded.hpp"

namespace dseam::hal::replay {

/// What `scene_camera.json` says of one view.
///
/// Shape:   intrinsics.width and height are 0 until the images are read.
struct ViewCamera {
  std::uint32_t id = 0;
  depth::Intrinsics intrinsics;
  double mm_per_count = 0.0;
  std::optional<geometry::RigidTransform> T_base_camera;
  std::optional<geometry::RigidTransform> T_base_flange;
  std::optional<std::int64_t> stamp_ns;
};

/// One view of a scan set: its camera and its images, row by row.
struct ScanView {
  ViewCamera camera;
  std::vector<std::uint16_t> depth;
  std::vector<std::uint8_t> gray;  ///< Empty where the set has no gray images.

  [[nodiscard]] depth::DepthImage image() const noexcept {
    return {camera.intrinsics, camera.mm_per_count, depth, gray};
  }
};

/// A scan set, its views in ascending order of their numbers.
struct ScanSet {
  std::vector<ScanView> views;
};

inline constexpr std::size_t kMaxViewsInSet = 1000;

/// Reads a whole set in the BOP layout and believes nothing in it.
///
/// Errors:  one line that names the file and the fault: missing, truncated or of another kind,
///          depth and gray of different sizes, a camera matrix that is none, a rotation that is
///          none, numbers that are not finite.
[[nodiscard]] Loaded<ScanSet> read_scan_set(const std::filesystem::path& set);

/// The text of `scene_camera.json`; `file` is only named in the fault.
[[nodiscard]] Loaded<std::vector<ViewCamera>> parse_scene_camera(std::string_view text,
                                                                 const std::filesystem::path& file);

/// Writes a set under a temporary name; commit() gives it its own, so that nobody sees half a set.
class ScanSetWriter {
 public:
  /// Errors:  `set` exists, or its folder cannot be made.
  [[nodiscard]] static Loaded<ScanSetWriter> create(const std::filesystem::path& set);
  ScanSetWriter(ScanSetWriter&& other) noexcept;
  ScanSetWriter& operator=(ScanSetWriter&&) = delete;
  /// Removes what was not committed.
  ~ScanSetWriter();

  /// Adds a view. Its size and number come from `view.camera`.
  ///
  /// Errors:  images of another size than the camera's; the disk is full.
  [[nodiscard]] std::optional<LoadFault> add(const ScanView& view);
  [[nodiscard]] std::optional<LoadFault> commit();
  [[nodiscard]] std::size_t size() const noexcept { return cameras_.size(); }

 private:
  ScanSetWriter(std::filesystem::path set, std::filesystem::path partial);

  std::filesystem::path set_;
  std::filesystem::path partial_;  ///< Empty once committed.
  std::vector<ViewCamera> cameras_;
};

}  // namespace dseam::hal::replay
