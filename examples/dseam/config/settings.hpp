// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "config/key.hpp"
#include "dseam/calibration/hand_eye.hpp"
#include "dseam/hal/sim/cell_config.hpp"
#include "dseam/pipeline/motion_chain.hpp"
#include "dseam/pipeline/paper_pipeline.hpp"
#include "dseam/pipeline/seam_chain.hpp"
#include "dseam/pipeline/weld_pipeline.hpp"
#include "robot/weld_run.hpp"
#include "scan/live_settings.hpp"

namespace dseam::program {

enum class Method : std::uint8_t { kDseam, kPaper };

/// What `extract` looks for: a ring round a nozzle, or the line between two plates.
enum class SeamShape : std::uint8_t { kClosed, kOpen };

/// The paper's values, with boxes so wide that nothing lies beyond.
[[nodiscard]] pipeline::PaperPipeline::Config unconstrained_paper();

/// Which ring is meant where a part has several.
struct RingChoice {
  double expected_radius_mm = 0.0;  ///< 0: any.
  std::array<double, 3> region_min_mm{-1e6, -1e6, -1e6};
  std::array<double, 3> region_max_mm{1e6, 1e6, 1e6};

  [[nodiscard]] std::optional<pipeline::RegionOfInterest> region() const;
  [[nodiscard]] std::optional<double> radius_mm() const;
};

/// Everything that can be configured, in the structs that the stages are made from.
struct Settings {
  Method method = Method::kDseam;
  SeamShape shape = SeamShape::kClosed;
  std::uint32_t max_points = 4'000'000;
  std::uint32_t max_seam_points = 16384;
  std::uint32_t max_voxels = 600'000;
  pipeline::SeamChain::Config seam;
  RingChoice ring;
  pipeline::PaperPipeline::Config paper = unconstrained_paper();
  pipeline::WeldPipeline::Config pipeline;  ///< Its `seam` is the one above.
  calibration::HandEyeConfig hand_eye;
  pipeline::MotionChain::Config motion;
  WeldRun::Config session;
  hal::sim::CellConfig cell;
  LiveSettings camera;
};

/// The table of all keys, bound to `settings`, which must outlive it.
[[nodiscard]] std::vector<Key> keys_of(Settings& settings);

/// Refuses what does not go together, before anything is opened: a least value that is not under
/// its greatest one, a plan that the gates of the weld would not let pass.
///
/// Errors:  throws Failure(kUsage): a line for each contradiction, with the names of both keys and
///          the place where one of them was set.
void check_together(const Settings& settings, const std::vector<Key>& keys);

}  // namespace dseam::program
