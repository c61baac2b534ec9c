// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/splice_chain.hpp"

#include <algorithm>

namespace dseam::pipeline {
namespace {

using splice::LiveSplicer;
using splice::NetworkReport;
using splice::PatchField;

std::size_t max_landmarks(const SpliceChain::Capacity& c) noexcept {
  return c.max_views * c.max_markers_a_view;
}

}  // namespace

std::size_t SpliceChain::bytes(const Capacity& c) noexcept {
  const std::size_t a_view =
      Arena::bytes<splice::SurfacePatch>(PatchField::size_for(c.width, c.height)) +
      Arena::bytes<markers::Marker>(c.max_markers_a_view) +
      Arena::bytes<std::uint16_t>(c.max_markers_a_view);
  return markers::MarkerFinder::bytes(c.width) + markers::MarkerMatcher::bytes(max_landmarks(c)) +
         splice::ViewNetwork::bytes() + splice::PipeFinder::bytes() + c.max_views * a_view +
         Arena::bytes<ViewStore>(c.max_views) + Arena::bytes<splice::PosedView>(c.max_views) +
         Arena::bytes<splice::NetworkView>(c.max_views) +
         Arena::bytes<splice::PipePair>(c.max_views) +
         Arena::bytes<Eigen::Vector3d>(max_landmarks(c)) +
         Arena::bytes<splice::MarkerSight>(max_landmarks(c)) +
         Arena::bytes<Eigen::Vector3d>(c.max_markers_a_view) +
         Arena::bytes<geometry::Ellipse>(c.max_markers_a_view);
}

Result<SpliceChain> SpliceChain::make(const Config& config, const Capacity& c,
                                      Arena& arena) noexcept {
  if (c.max_views == 0 || c.max_views > cloud::kMaxViews || c.max_markers_a_view < 3 ||
      max_landmarks(c) >= kNoLandmark) {
    return Errc::kInvalidArgument;
  }
  SpliceChain chain(config, c);
  if (const Result<> built = chain.build_stages(arena); !built.ok()) {
    return built.error();
  }
  chain.take_stores(arena);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return chain;
}

// Not inlined: stages are large objects.
[[gnu::noinline]] Result<> SpliceChain::build_stages(Arena& arena) noexcept {
  const auto finder = markers::MarkerFinder::make(config_.finder, capacity_.width, arena);
  const auto matcher =
      markers::MarkerMatcher::make(config_.matcher, max_landmarks(capacity_), arena);
  const auto network = splice::ViewNetwork::make(config_.network, arena);
  const auto pipes = splice::PipeFinder::make(config_.pipes, arena);
  if (!finder.ok() || !matcher.ok()) {
    return !finder.ok() ? finder.error() : matcher.error();
  }
  if (!network.ok() || !pipes.ok()) {
    return !network.ok() ? network.error() : pipes.error();
  }
  finder_ = finder.value();
  matcher_ = matcher.value();
  network_ = network.value();
  pipes_ = pipes.value();
  return {};
}

void SpliceChain::take_stores(Arena& arena) noexcept {
  const Capacity& c = capacity_;
  stores_ = arena.take<ViewStore>(c.max_views);
  for (ViewStore& store : stores_) {
    store.patches = arena.take<splice::SurfacePatch>(PatchField::size_for(c.width, c.height));
    store.markers = Buffer(arena.take<markers::Marker>(c.max_markers_a_view));
    store.landmarks = arena.take<std::uint16_t>(c.max_markers_a_view);
  }
  posed_ = arena.take<splice::PosedView>(c.max_views);
  inputs_ = arena.take<splice::NetworkView>(c.max_views);
  pairs_ = arena.take<splice::PipePair>(c.max_views);
  landmarks_ = Buffer(arena.take<Eigen::Vector3d>(max_landmarks(c)));
  sights_ = Buffer(arena.take<splice::MarkerSight>(max_landmarks(c)));
  places_ = arena.take<Eigen::Vector3d>(c.max_markers_a_view);
  hidden_ = arena.take<geometry::Ellipse>(c.max_markers_a_view);
}

void SpliceChain::clear() noexcept {
  num_views_ = 0;
  landmarks_.clear();
  sights_.clear();
}

bool SpliceChain::fits(const depth::DepthImage& frame) const noexcept {
  const depth::Intrinsics& k = frame.intrinsics;
  return num_views_ < stores_.size() && k.width == capacity_.width &&
         k.height == capacity_.height && frame.depth.size() == std::size_t{k.width} * k.height &&
         k.fx > 0.0 && k.fy > 0.0;
}

SpliceChain::ViewReport SpliceChain::add(const depth::DepthImage& frame,
                                         const splice::ReportedPose& reported) noexcept {
  ViewReport report;
  if (!fits(frame)) {
    report.live.state = LiveSplicer::State::kNotTakenIn;
    return report;
  }
  extract(frame, report);
  // What is no rigid transform (scaled, left-handed, not finite) says nothing.
  report.reported_refused =
      reported.known && !geometry::rigid_from_parts(reported.T_base_camera.rotation,
                                                    reported.T_base_camera.translation_mm)
                             .ok();
  stores_[num_views_].reported = report.reported_refused ? splice::ReportedPose{} : reported;
  const std::size_t view = num_views_++;
  place(view, report);
  if (posed_[view].used) {
    place_pending();
  }
  return report;
}

void SpliceChain::extract(const depth::DepthImage& frame, ViewReport& report) noexcept {
  ViewStore& store = stores_[num_views_];
  report.markers = finder_->run(frame, store.markers);
  std::fill(store.landmarks.begin(), store.landmarks.end(), kNoLandmark);
  const std::size_t n = store.markers.size();
  for (std::size_t i = 0; i < n; ++i) {
    hidden_[i] = store.markers[i].ellipse;
  }
  report.patches = patches_.run(frame, hidden_.first(n), store.patches);
  const std::uint32_t columns = capacity_.width / PatchField::kBlockPx;
  const std::uint32_t rows = capacity_.height / PatchField::kBlockPx;
  store.pair_sought = false;
  posed_[num_views_] = {};
  posed_[num_views_].field = {frame.intrinsics, columns, rows,
                              store.patches.first(std::size_t{columns} * rows)};
}

bool SpliceChain::match(std::size_t view, ViewReport& report) noexcept {
  const std::span<const markers::Marker> seen = stores_[view].markers.view();
  const splice::ReportedPose& reported = stores_[view].reported;
  if (seen.size() < 3 || landmarks_.size() < 3) {
    return false;
  }
  std::transform(seen.begin(), seen.end(), places_.begin(),
                 [](const markers::Marker& m) { return m.p_camera; });
  const auto in_view = std::span<const Eigen::Vector3d>(places_.first(seen.size()));
  if (reported.known) {
    report.match = matcher_->run(landmarks_.view(), in_view, reported.T_base_camera);
  }
  if (report.match.state != markers::MatchState::kMatched) {
    // The report may be wrong, and with it the frame of those before.
    report.match = matcher_->run(landmarks_.view(), in_view, std::nullopt);
  }
  return report.match.state == markers::MatchState::kMatched;
}

// A marker near a known one is that one; of the others each is new.
void SpliceChain::enter_landmarks(std::size_t view) noexcept {
  constexpr double kSameMm = 0.8;
  ViewStore& store = stores_[view];
  const std::size_t known = landmarks_.size();
  for (std::size_t i = 0; i < store.markers.size(); ++i) {
    const Eigen::Vector3d p = posed_[view].T_base_camera * store.markers[i].p_camera;
    double nearest = kSameMm;
    for (std::size_t k = 0; k < known; ++k) {
      const double distance = (landmarks_[k] - p).norm();
      if (distance < nearest) {
        nearest = distance;
        store.landmarks[i] = static_cast<std::uint16_t>(k);
      }
    }
    if (store.landmarks[i] == kNoLandmark && landmarks_.append(p)) {
      store.landmarks[i] = static_cast<std::uint16_t>(landmarks_.size() - 1);
    }
  }
}

std::span<const markers::Marker> SpliceChain::markers(std::size_t view) const noexcept {
  return view < num_views_ ? stores_[view].markers.view() : std::span<const markers::Marker>{};
}

void SpliceChain::collect_sights() noexcept {
  sights_.clear();
  for (std::size_t k = 0; k < landmarks_.size(); ++k) {
    for (std::size_t v = 0; v < num_views_; ++v) {
      const ViewStore& store = stores_[v];
      for (std::size_t i = 0; i < store.markers.size(); ++i) {
        if (store.landmarks[i] == k) {
          const markers::Marker& m = store.markers[i];
          (void)sights_.append({static_cast<std::uint16_t>(v), static_cast<std::uint16_t>(k),
                                m.p_camera, m.covariance_mm2});
        }
      }
    }
  }
}

NetworkReport SpliceChain::finish(Buffer<splice::SplicedView>& out) noexcept {
  place_pending();
  choose_first();
  collect_sights();
  NetworkReport report = network_->run(inputs_.first(num_views_), sights_.view(), out);
  name_ambiguous(out);
  return report;
}

NetworkReport SpliceChain::run(std::span<const depth::DepthImage> frames,
                               std::span<const splice::ReportedPose> reported,
                               Buffer<splice::SplicedView>& out) noexcept {
  clear();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    (void)add(frames[i], i < reported.size() ? reported[i] : splice::ReportedPose{});
  }
  return finish(out);
}

}  // namespace dseam::pipeline
