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
         splice::ViewNetwork::bytes() + c.max_views * a_view +
         Arena::bytes<ViewStore>(c.max_views) + Arena::bytes<splice::PosedView>(c.max_views) +
         Arena::bytes<splice::NetworkView>(c.max_views) +
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
  const auto finder = markers::MarkerFinder::make(config.finder, c.width, arena);
  const auto matcher = markers::MarkerMatcher::make(config.matcher, max_landmarks(c), arena);
  const auto network = splice::ViewNetwork::make(config.network, arena);
  if (!finder.ok() || !matcher.ok() || !network.ok()) {
    return !finder.ok() ? finder.error() : !matcher.ok() ? matcher.error() : network.error();
  }
  chain.finder_ = finder.value();
  chain.matcher_ = matcher.value();
  chain.network_ = network.value();
  chain.stores_ = arena.take<ViewStore>(c.max_views);
  for (ViewStore& store : chain.stores_) {
    store.patches = arena.take<splice::SurfacePatch>(PatchField::size_for(c.width, c.height));
    store.markers = Buffer(arena.take<markers::Marker>(c.max_markers_a_view));
    store.landmarks = arena.take<std::uint16_t>(c.max_markers_a_view);
  }
  chain.posed_ = arena.take<splice::PosedView>(c.max_views);
  chain.inputs_ = arena.take<splice::NetworkView>(c.max_views);
  chain.landmarks_ = Buffer(arena.take<Eigen::Vector3d>(max_landmarks(c)));
  chain.sights_ = Buffer(arena.take<splice::MarkerSight>(max_landmarks(c)));
  chain.places_ = arena.take<Eigen::Vector3d>(c.max_markers_a_view);
  chain.hidden_ = arena.take<geometry::Ellipse>(c.max_markers_a_view);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return chain;
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

// A view that shares too little with those before it may share more with those after it.
void SpliceChain::place_pending() noexcept {
  for (std::size_t round = 0; round < num_views_; ++round) {
    bool placed_one = false;
    for (std::size_t view = 0; view < num_views_; ++view) {
      if (!posed_[view].used) {
        ViewReport report;
        place(view, report);
        placed_one = placed_one || posed_[view].used;
      }
    }
    if (!placed_one) {
      return;
    }
  }
}

std::size_t SpliceChain::num_standing() const noexcept {
  const auto views = posed_.first(num_views_);
  return static_cast<std::size_t>(
      std::count_if(views.begin(), views.end(), [](const auto& view) { return view.used; }));
}

// All views once more, `first` before the others.
void SpliceChain::start_from(std::size_t first) noexcept {
  landmarks_.clear();
  for (std::size_t view = 0; view < num_views_; ++view) {
    posed_[view].used = false;
    std::fill(stores_[view].landmarks.begin(), stores_[view].landmarks.end(), kNoLandmark);
  }
  ViewReport report;
  place(first, report);
  place_pending();
}

// The others hang on the view that stands first. Where some find nothing to hang on, another one
// may tie more of them.
void SpliceChain::choose_first() noexcept {
  std::size_t best = 0;
  std::size_t most = num_standing();
  std::size_t tried = 0;
  for (std::size_t view = 1; view < num_views_ && most < num_views_; ++view) {
    start_from(view);
    tried = view;
    if (num_standing() > most) {
      best = view;
      most = num_standing();
    }
  }
  if (tried != best) {
    start_from(best);
  }
  move_to_first_camera();
}

// Where nobody reports, the frame is that of the first camera, whichever view the others hang on.
void SpliceChain::move_to_first_camera() noexcept {
  const auto stores = stores_.first(num_views_);
  const bool any_reported =
      std::any_of(stores.begin(), stores.end(), [](const auto& s) { return s.reported.known; });
  if (any_reported || num_views_ == 0 || !posed_[0].used) {
    return;
  }
  const geometry::RigidTransform T_first_base = posed_[0].T_camera_base;
  for (std::size_t view = 0; view < num_views_; ++view) {
    posed_[view].place(T_first_base * posed_[view].T_base_camera);
    inputs_[view].start_T_base_camera = posed_[view].T_base_camera;
  }
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
  posed_[num_views_] = {};
  posed_[num_views_].field = {frame.intrinsics, columns, rows,
                              store.patches.first(std::size_t{columns} * rows)};
}

// By the markers when they are sure, else by the report; then surface against surface.
void SpliceChain::place(std::size_t index, ViewReport& report) noexcept {
  splice::PosedView& view = posed_[index];
  const splice::ReportedPose& reported = stores_[index].reported;
  const bool by_markers = match(index, report);
  view.place(by_markers ? report.match.T_a_b : reported.T_base_camera);
  const bool first = can_be_first(index);
  const bool guessed = by_markers || reported.known || first;
  report.live.T_base_camera = view.T_base_camera;
  if (guessed) {
    report.live = live_.run(view, posed_.first(num_views_));
    view.place(report.live.T_base_camera);
  }
  const bool stands = first || by_markers || report.live.state == LiveSplicer::State::kSpliced;
  view.used = stands;
  if (stands) {
    enter_landmarks(index);
  }
  inputs_[index] = {view.field, reported, view.T_base_camera, guessed};
}

// The frame is that of the first view which shows something to splice to.
bool SpliceChain::can_be_first(std::size_t view) const noexcept {
  const auto seen = posed_.first(num_views_);
  const std::span<const splice::SurfacePatch> patches = posed_[view].field.patches;
  return std::none_of(seen.begin(), seen.end(), [](const auto& other) { return other.used; }) &&
         (stores_[view].markers.size() >= 3 ||
          std::any_of(patches.begin(), patches.end(),
                      [](const splice::SurfacePatch& p) { return p.num_pixels > 0; }));
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
  return network_->run(inputs_.first(num_views_), sights_.view(), out);
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
