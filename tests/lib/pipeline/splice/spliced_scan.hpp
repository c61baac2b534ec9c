// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "dseam/hal/sim/cell.hpp"
#include "dseam/pipeline/splice_chain.hpp"

namespace dseam::test {

/// A cell's frames, rendered once for all tests that look at them.
struct Scan {
  hal::sim::CellConfig config;
  std::vector<hal::sim::Rendering> renderings;
  std::vector<depth::DepthImage> frames;
  std::vector<splice::ReportedPose> reported;
  std::vector<geometry::RigidTransform> truth;
  hal::sim::TruthCurve seam;
};
[[nodiscard]] Scan scan(const hal::sim::CellConfig& config);
/// The default cell, with its 18 markers and without any.
[[nodiscard]] const Scan& marked_scan();
[[nodiscard]] const Scan& bare_scan();

struct Spliced {
  splice::NetworkReport report;
  std::vector<splice::SplicedView> views;
};

/// All frames through one chain. Nothing is allocated on the way, or the test fails.
[[nodiscard]] Spliced splice_all(std::span<const depth::DepthImage> frames,
                                 std::span<const splice::ReportedPose> reported);
/// Of the views used, at the true seam.
[[nodiscard]] double splice_error_mm(const Scan& scan, const Spliced& spliced);

}  // namespace dseam::test
