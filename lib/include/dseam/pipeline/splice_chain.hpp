// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/depth/depth_image.hpp"
#include "dseam/markers/marker_finder.hpp"
#include "dseam/markers/marker_matcher.hpp"
#include "dseam/splice/live_splicer.hpp"
#include "dseam/splice/pipes/pipe_finder.hpp"
#include "dseam/splice/pipes/pipe_placer.hpp"
#include "dseam/splice/spliced_view.hpp"
#include "dseam/splice/surface_patches.hpp"
#include "dseam/splice/view_network.hpp"

namespace dseam::pipeline {

/// From frames and reported poses to one pose for each view.
///
/// A view is added as soon as it is seen: its markers and surface patches are kept, and it is
/// spliced to those before it, by the pipes it shows where neither markers nor the reported pose
/// bring it to them. finish() adjusts all of them together.
///
/// Frame:   base; without any reported pose, the camera of the first view.
/// Memory:  `bytes()` from the arena at make(); the frames themselves are not kept.
/// Time:    add() O(pixels); finish() O(patches) for a bounded number of iterations.
/// Context: one thread; not the cycle path.
class SpliceChain {
 public:
  struct Config {
    markers::MarkerFinder::Config finder;
    markers::MarkerMatcher::Config matcher;
    splice::PatchExtractor::Config patches;
    splice::LiveSplicer::Config live;
    splice::PipeFinder::Config pipes;
    splice::PipePlacer::Config placer;
    splice::ViewNetwork::Config network;
  };
  struct Capacity {
    std::uint32_t width = 1296;
    std::uint32_t height = 966;
    std::size_t max_views = 8;
    std::size_t max_markers_a_view = 64;
  };
  struct ViewReport {
    bool reported_refused = false;  ///< The reported pose is no rigid transform; not used.
    markers::MarkerFinder::Report markers;
    markers::MatchReport match;
    splice::PatchExtractor::Report patches;
    splice::LiveSplicer::Report live;
    splice::PipePairState pair = splice::PipePairState::kNoPipe;  ///< Where it was sought.
    splice::PipePlacer::Report pipes;
  };

  [[nodiscard]] static std::size_t bytes(const Capacity& capacity) noexcept;
  /// Errors:  kInvalidArgument, kOutOfMemory.
  [[nodiscard]] static Result<SpliceChain> make(const Config& config, const Capacity& capacity,
                                                Arena& arena) noexcept;

  /// Forgets all views.
  void clear() noexcept;
  /// Takes the next view in and splices it to those before. A view beyond the capacity, or a frame
  /// of another size, is not taken in: its `live.state` says so.
  ViewReport add(const depth::DepthImage& frame, const splice::ReportedPose& reported) noexcept;
  /// The markers found in a view, so that fusing can leave their pixels out.
  [[nodiscard]] std::span<const markers::Marker> markers(std::size_t view) const noexcept;
  /// One entry a view in `out`, in the order of add().
  splice::NetworkReport finish(Buffer<splice::SplicedView>& out) noexcept;
  /// How the views' errors hang together, after finish().
  [[nodiscard]] const splice::JointCovariance& joint_covariance() const noexcept {
    return network_->joint_covariance();
  }

  /// clear(), add() for every frame, finish().
  ///
  /// Shape:   `reported` has one entry a frame, or is empty.
  splice::NetworkReport run(std::span<const depth::DepthImage> frames,
                            std::span<const splice::ReportedPose> reported,
                            Buffer<splice::SplicedView>& out) noexcept;

 private:
  struct ViewStore {
    splice::ReportedPose reported;
    std::span<splice::SurfacePatch> patches;
    Buffer<markers::Marker> markers;
    std::span<std::uint16_t> landmarks;  ///< Of each marker; kNoLandmark where it has none.
    bool pair_sought = false;
    splice::PipePlacer::State pipes = splice::PipePlacer::State::kNotSought;
  };
  static constexpr std::uint16_t kNoLandmark = 0xFFFF;

  SpliceChain(const Config& config, const Capacity& capacity) noexcept
      : config_(config),
        capacity_(capacity),
        patches_(config.patches),
        live_(config.live),
        placer_(config.placer, config.live) {}
  [[nodiscard]] Result<> build_stages(Arena& arena) noexcept;
  void take_stores(Arena& arena) noexcept;
  [[nodiscard]] bool fits(const depth::DepthImage& frame) const noexcept;
  void extract(const depth::DepthImage& frame, ViewReport& report) noexcept;
  void place(std::size_t view, ViewReport& report) noexcept;
  void seek_pipes(std::size_t view) noexcept;
  [[nodiscard]] bool place_by_pipes(std::size_t view, ViewReport& report) noexcept;
  void name_ambiguous(Buffer<splice::SplicedView>& out) const noexcept;
  void place_pending() noexcept;
  [[nodiscard]] std::size_t num_standing() const noexcept;
  void start_from(std::size_t first) noexcept;
  void choose_first() noexcept;
  void move_to_first_camera() noexcept;
  [[nodiscard]] bool can_be_first(std::size_t view) const noexcept;
  [[nodiscard]] bool match(std::size_t view, ViewReport& report) noexcept;
  void enter_landmarks(std::size_t view) noexcept;
  void collect_sights() noexcept;

  Config config_;
  Capacity capacity_;
  splice::PatchExtractor patches_;
  splice::LiveSplicer live_;
  splice::PipePlacer placer_;
  std::optional<markers::MarkerFinder> finder_;
  std::optional<markers::MarkerMatcher> matcher_;
  std::optional<splice::ViewNetwork> network_;
  std::optional<splice::PipeFinder> pipes_;
  std::span<ViewStore> stores_;
  std::span<splice::PosedView> posed_;
  std::span<splice::NetworkView> inputs_;
  std::span<splice::PipePair> pairs_;
  std::size_t num_views_ = 0;
  Buffer<Eigen::Vector3d> landmarks_;  ///< Where each was first seen, base.
  Buffer<splice::MarkerSight> sights_;
  std::span<Eigen::Vector3d> places_;  ///< The present view's markers, camera.
  std::span<geometry::Ellipse> hidden_;
};

}  // namespace dseam::pipeline
