// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/depth/depth_image.hpp"
#include "dseam/seam/curve/coverage.hpp"
#include "dseam/seam/curve/curve_builder.hpp"
#include "dseam/seam/edge/edge_curve.hpp"
#include "dseam/seam/edge/edge_scanner.hpp"
#include "dseam/seam/joint/joint_fit.hpp"
#include "dseam/seam/joint/ring_finder.hpp"
#include "dseam/seam/seam_curve.hpp"
#include "dseam/seam/seam_report.hpp"
#include "dseam/seam/surface/cell_map.hpp"
#include "dseam/seam/surface/surface_finder.hpp"
#include "dseam/splice/spliced_view.hpp"

namespace dseam::pipeline {

/// An axis-aligned box in base.
struct RegionOfInterest {
  Eigen::Vector3d min_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d max_base = Eigen::Vector3d::Zero();
};

/// What the seam is sought in. Only the cloud is needed; frames make edges at a gap sharper.
///
/// Shape:   `views[i]` is the pose of `frames[i]`; both may be empty.
struct SeamInput {
  cloud::FusedCloudView cloud_base;
  std::span<const depth::DepthImage> frames{};
  std::span<const splice::SplicedView> views{};
  std::optional<RegionOfInterest> region{};
  std::optional<double> expected_radius_mm{};
  std::optional<seam::ReferenceCurve> reference{};  ///< In place of the configured one.
};

/// From a fused cloud to the one closed seam in it, or to the reason why there is none.
///
/// Where too little was seen of a ring on a plane, the joint is sought once more at the nozzles'
/// feet (seam::FootSearch) before it is refused.
///
/// Frame:   base.
/// Memory:  `bytes()` from the arena at make(); run() takes none.
/// Time:    bounded by the capacities; linear in points and pixels.
/// Context: one thread; not the cycle path.
class SeamChain {
 public:
  struct Config {
    seam::ReferenceCurve reference = seam::ReferenceCurve::kShellEdge;
    double min_coverage = 0.80;
    double max_hole_rad = 1.0471975511965976;  ///< 60 degrees.
    double max_sigma_mm = 0.3;  ///< Of every measured point: medium confidence at least.
    double point_spacing_mm = 0.5;
    double start_angle_rad = 0.0;     ///< About the nozzle's axis, from base x laid into the ring.
    bool counter_clockwise = true;    ///< Seen from the nozzle's free end.
    double scanner_sigma_mm = 0.008;  ///< Of depth, what its calibration leaves in all views alike.
    double hand_eye_sigma_mm = 0.0;   ///< 0: not known; added to the predicted sigmas.
  };
  struct Capacity {
    std::size_t max_points = 262144;
    std::size_t max_edge_intervals = 16384;
  };

  [[nodiscard]] static std::size_t bytes(const Capacity& capacity) noexcept;
  /// kInvalidArgument: a value outside its range. kOutOfMemory: the arena is too small.
  [[nodiscard]] static Result<SeamChain> make(const Config& config, const Capacity& capacity,
                                              Arena& arena) noexcept;

  seam::SeamReport run(const SeamInput& in, Buffer<seam::SeamPoint>& out) noexcept;

 private:
  struct Workspace {
    seam::RingCoverage coverage;
    seam::CurveBuilder builder;
    seam::EdgeCurve shell_edge;
    seam::EdgeCurve nozzle_edge;
  };

  SeamChain(const Config& config, const Capacity& capacity, Arena& arena) noexcept;

  enum class Search : std::uint8_t { kSurfaces, kFeet };
  bool attempt(const SeamInput& in, Search search, seam::SeamReport& report,
               Buffer<seam::SeamPoint>& out) noexcept;
  bool find_joint(const SeamInput& in, Search search, seam::SeamReport& report,
                  seam::Joint& joint) noexcept;
  bool fit_joint(const SeamInput& in, const seam::Joint& joint, seam::SeamReport& report) noexcept;
  bool find_edges(const SeamInput& in, seam::SeamReport& report) noexcept;
  bool scan_edge(const SeamInput& in, seam::EndingSurface::Which which,
                 seam::SeamReport& report) noexcept;
  [[nodiscard]] bool has(seam::ReferenceCurve reference) const noexcept;
  void build_curve(const SeamInput& in, seam::SeamReport& report,
                   Buffer<seam::SeamPoint>& out) noexcept;

  Config config_;
  seam::CellMap cells_;
  seam::SurfaceFinder surfaces_;
  seam::RingFinder rings_;
  seam::JointFit fit_;
  seam::EdgeScanner edges_;
  std::span<Workspace> work_;
  std::span<float> scratch_;
  seam::JointEdges found_;
  std::optional<seam::Surface> bore_;
  double tolerance_mm_ = 1.0;
};

}  // namespace dseam::pipeline
