// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/pipeline/seam_chain.hpp"
#include "dseam/seam/open/fillet_finder.hpp"
#include "dseam/seam/open/open_curve.hpp"
#include "dseam/seam/open/open_sides.hpp"
#include "dseam/seam/open/slit_finder.hpp"

namespace dseam::pipeline {

/// From a fused cloud to the one open seam in it, the fillet between two surfaces or the gap
/// between two plates, or to the reason why there is none.
///
/// Frame:   base.
/// Memory:  `bytes()` from the arena at make(); run() takes none.
/// Time:    bounded by the capacities; linear in points.
/// Context: one thread; not the cycle path.
class OpenSeamChain {
 public:
  using Config = SeamChain::Config;  ///< `start_angle_rad` is not used.
  using Capacity = SeamChain::Capacity;

  [[nodiscard]] static std::size_t bytes(const Capacity& capacity) noexcept;
  /// kInvalidArgument: a value outside its range. kOutOfMemory: the arena is too small.
  [[nodiscard]] static Result<OpenSeamChain> make(const Config& config, const Capacity& capacity,
                                                  Arena& arena) noexcept;

  /// Holes are shares of a whole turn; the frames themselves are not looked at, only from where
  /// they were taken.
  seam::SeamReport run(const SeamInput& in, Buffer<seam::SeamPoint>& out) noexcept;

 private:
  static constexpr std::size_t kMaxFound = 64;

  OpenSeamChain(const Config& config, const Capacity& capacity, Arena& arena) noexcept;

  bool find_surfaces(const SeamInput& in, seam::SeamReport& report) noexcept;
  bool choose(const SeamInput& in, seam::SeamReport& report) noexcept;
  bool fit(const SeamInput& in, seam::SeamReport& report) noexcept;
  void build_curve(const SeamInput& in, seam::SeamReport& report,
                   Buffer<seam::SeamPoint>& out) noexcept;

  Config config_;
  seam::CellMap cells_;
  seam::SurfaceFinder surfaces_;
  seam::FilletFinder fillets_;
  seam::SlitFinder slits_;
  Buffer<seam::OpenCandidate> found_;
  seam::SeamTrack track_;
  std::span<seam::OpenSides> sides_;
  seam::OpenJoint joint_;
  double tolerance_mm_ = 1.0;
  double cell_mm_ = 4.0;
};

}  // namespace dseam::pipeline
