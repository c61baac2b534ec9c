// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "dseam/pipeline/splice_chain.hpp"

namespace dseam::pipeline {

using splice::LiveSplicer;
using splice::PipePlacer;

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

// By the markers when they are sure, else by the report; then surface against surface. Where that
// does not hold, by the pipes.
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
  const bool by_surfaces = report.live.state == LiveSplicer::State::kSpliced;
  const bool by_pipes = !first && !by_markers &&
                        (!by_surfaces || placer_.contradicted(report.live)) &&
                        place_by_pipes(index, report);
  stores_[index].pipes = report.pipes.state;
  view.used = first || by_markers || by_surfaces || by_pipes;
  if (view.used) {
    enter_landmarks(index);
  }
  inputs_[index] = {view.field, reported, view.T_base_camera, guessed || by_pipes};
}

// Pipes are sought in a view when somebody asks for them, once.
void SpliceChain::seek_pipes(std::size_t view) noexcept {
  if (!stores_[view].pair_sought) {
    pairs_[view] = pipes_->run(posed_[view].field);
    stores_[view].pair_sought = true;
  }
}

bool SpliceChain::place_by_pipes(std::size_t index, ViewReport& report) noexcept {
  seek_pipes(index);
  for (std::size_t v = 0; v < num_views_; ++v) {
    if (posed_[v].used) {
      seek_pipes(v);
    }
  }
  report.pair = pairs_[index].state;
  report.pipes = placer_.run(posed_[index], pairs_[index], stores_[index].reported,
                             posed_.first(num_views_), pairs_.first(num_views_));
  if (report.pipes.state != PipePlacer::State::kPlaced) {
    return false;
  }
  report.live = report.pipes.live;
  posed_[index].place(report.live.T_base_camera);
  return true;
}

// Nobody has seen a view in its place that its pipes put in several. Where it was reported apart
// from all others, that is what is said of it.
void SpliceChain::name_ambiguous(Buffer<splice::SplicedView>& out) const noexcept {
  for (std::size_t v = 0; v < out.size(); ++v) {
    if (out[v].state == splice::ViewState::kNoOverlap && !stores_[v].reported.known &&
        stores_[v].pipes == PipePlacer::State::kAmbiguous) {
      out[v].state = splice::ViewState::kAmbiguous;
    }
  }
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

}  // namespace dseam::pipeline
