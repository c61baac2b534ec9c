// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "dseam/base/result.hpp"
#include "dseam/hal/sim/scanner.hpp"
#include "dseam/hal/sim/scene.hpp"
#include "dseam/hal/sim/truth.hpp"

namespace dseam::hal::sim {

/// Where one view was really taken from, and from where the robot says it was.
struct CellView {
  geometry::RigidTransform T_base_camera;
  geometry::RigidTransform T_base_camera_reported;
};

/// The simulated workpiece, scanner and robot poses, and the truth about all of them.
///
/// Frame:   base, but for `scene()`, which is in the part's.
class Cell {
 public:
  /// Errors:  kInvalidArgument: `fault_in(config)` says what.
  [[nodiscard]] static Result<Cell> make(const CellConfig& config);

  [[nodiscard]] const CellConfig& config() const noexcept { return config_; }
  [[nodiscard]] const Scene& scene() const noexcept { return scene_; }
  [[nodiscard]] const std::vector<CellView>& views() const noexcept { return views_; }
  [[nodiscard]] const std::vector<Eigen::Vector3d>& markers() const noexcept { return markers_; }
  /// The true seam; none where the joint does not have that curve.
  [[nodiscard]] std::optional<TruthCurve> seam(
      seam::ReferenceCurve reference = seam::ReferenceCurve::kShellEdge) const;
  /// What the scanner gives in view `i`.
  void scan(std::size_t i, Rendering& out) const;

 private:
  explicit Cell(const CellConfig& config);

  CellConfig config_;
  Scene scene_;
  Blind blind_;
  std::vector<CellView> views_;
  std::vector<Eigen::Vector3d> markers_;
};

/// Writes `truth_seam.csv` (shell_edge; the other curves as `truth_seam_root.csv` and so on),
/// `truth_markers.csv` and `truth_poses.json` into the existing folder `dir`.
///
/// Errors:  kIo: something could not be written.
[[nodiscard]] Result<> write_truth(const Cell& cell, const std::filesystem::path& dir);

}  // namespace dseam::hal::sim
