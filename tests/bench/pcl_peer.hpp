// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

/// The Point Cloud Library behind plain types: its own objects are compiled for the processor that
/// its Debian packages are compiled for, or their layouts would differ.
namespace dseam::bench {

class PclPeer {
 public:
  PclPeer(std::span<const float> x, std::span<const float> y, std::span<const float> z);
  ~PclPeer();

  void passthrough(float low_z_mm, float high_z_mm);
  void remove_outliers(int num_neighbours, double alpha);
  void downsample(float cell_mm);
  void estimate_normals(double radius_mm);
  void find_boundary(double radius_mm, float min_gap_rad);
  /// Each works on the result of the one before, as loaded by one of these.
  void use_input();
  void use_cropped();
  void use_cleaned();
  void use_cells();

  [[nodiscard]] std::vector<int> kept() const;  ///< Of the outlier removal.
  [[nodiscard]] std::size_t num_cells() const;
  [[nodiscard]] std::vector<float> cells_xyz() const;
  [[nodiscard]] std::vector<float> normals_xyz() const;
  [[nodiscard]] std::vector<std::uint8_t> boundary() const;

  /// Decode, to base, crop, downsample: what FrameFuser does in one pass. Returns cells.
  static std::size_t fuse_frame(std::span<const std::uint16_t> counts, std::uint32_t width,
                                double f, double cx, double cy, float mm_per_count,
                                std::span<const float, 16> T_base_camera, float half_box_mm,
                                float cell_mm);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dseam::bench
