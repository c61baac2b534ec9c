// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/cloud_splice_chain.hpp"

#include <algorithm>

#include "dseam/cloud/normals.hpp"

namespace dseam::pipeline {
namespace {

using geometry::RigidTransform;
using splice::SplicedView;
using splice::StartCandidate;
using splice::ViewState;

constexpr double kNormalRadius = 3.0;  // In noises or spacings, the larger.
constexpr double kReachSpacings = 2.0;
constexpr double kToleranceNoises = 3.0;
constexpr double kLeastToleranceMm = 0.2;

constexpr double kContradictionWeight = 3.0;
constexpr std::size_t kAsked = 2000;  // Points that are asked for their agreement.

Eigen::Vector3d at(const cloud::CloudView& cloud, std::size_t i) noexcept {
  return {static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
          static_cast<double>(cloud.z[i])};
}

search::Neighbour nearest(const search::GridIndex& index, const Eigen::Vector3d& p,
                          double reach_mm) noexcept {
  const Eigen::Vector3f q = p.cast<float>();
  return index.nearest({q.x(), q.y(), q.z()}, static_cast<float>(reach_mm));
}

struct Agreement {
  double sum = 0.0;
  double asked = 0.0;

  void add(const search::Neighbour& near, double off_mm, double noise_mm) noexcept {
    const double off = off_mm / std::max(kToleranceNoises * noise_mm, kLeastToleranceMm);
    sum += near.index == search::kNoPoint ? 0.0 : std::max(0.0, 1.0 - off * off);
    asked += 1.0;
  }
  [[nodiscard]] double mean() const noexcept { return sum / std::max(asked, 1.0); }
};

}  // namespace

std::size_t CloudSpliceChain::bytes(const Capacity& c) noexcept {
  return SurfaceStart::bytes(c.max_points) + 2 * search::GridIndex::bytes(c.max_points) +
         cloud::CloudBuffer::bytes(c.max_points) + cloud::NormalsBuffer::bytes(c.max_points) +
         Arena::bytes<StartCandidate>(SurfaceStart::kMaxCandidates) +
         Arena::bytes<CloudSpliceRow>(c.max_clouds) +
         Arena::bytes<splice::FrontView>(c.max_clouds) + c.max_clouds * splice::FrontView::bytes();
}

Result<CloudSpliceChain> CloudSpliceChain::make(const Config& config, const Capacity& c,
                                                Arena& arena) noexcept {
  if (!(config.tolerance_mm > 0.0) || c.max_clouds == 0 || c.max_points == 0) {
    return Errc::kInvalidArgument;
  }
  CloudSpliceChain chain(config);
  const auto start = SurfaceStart::make(config.search, c.max_points, arena);
  const auto index = search::GridIndex::make(c.max_points, arena);
  const auto source_index = search::GridIndex::make(c.max_points, arena);
  if (!start.ok() || !index.ok() || !source_index.ok()) {
    return !start.ok() ? start.error() : index.error();
  }
  chain.start_ = start.value();
  chain.index_ = index.value();
  chain.source_index_ = source_index.value();
  chain.target_ = cloud::CloudBuffer(c.max_points, arena);
  chain.normals_ = cloud::NormalsBuffer(c.max_points, arena);
  chain.refined_ = Buffer(arena.take<StartCandidate>(SurfaceStart::kMaxCandidates));
  chain.fronts_ = arena.take<splice::FrontView>(c.max_clouds);
  for (splice::FrontView& front : chain.fronts_) {
    front = splice::FrontView(arena);
  }
  chain.rows_ = Buffer(arena.take<CloudSpliceRow>(c.max_clouds));
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return chain;
}

std::size_t CloudSpliceChain::run(std::span<const cloud::CloudView> clouds,
                                  Buffer<SplicedView>& out) noexcept {
  clouds = clouds.first(std::min({clouds.size(), rows_.capacity(), out.capacity()}));
  out.clear();
  out.resize(clouds.size());
  rows_.clear();
  rows_.resize(clouds.size());
  std::fill(rows_.items().begin(), rows_.items().end(), CloudSpliceRow{});
  std::size_t placed = 0;
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    out[i] = {};
    fronts_[i].run(clouds[i], start_->scale_mm(clouds[i]));
    out[i].state = clouds[i].size() == 0 ? ViewState::kEmpty : ViewState::kNoOverlap;
    if (placed == 0 && clouds[i].size() > 0) {
      out[i].state = ViewState::kUsed;
      placed = 1;
    }
  }
  // A cloud that does not meet those before it may meet those after it.
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < clouds.size(); ++i) {
      const bool waits =
          out[i].state == ViewState::kNoOverlap || out[i].state == ViewState::kAmbiguous;
      if (placed > 0 && waits && place(clouds, i, out)) {
        ++placed;
        again = true;
      }
    }
  }
  settle(clouds, out);
  return placed;
}

// All placed clouds but one, in the common frame, thinned to what fits.
void CloudSpliceChain::gather(std::span<const cloud::CloudView> clouds,
                              std::span<const SplicedView> views, std::size_t without) noexcept {
  std::size_t total = 0;
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    total += i != without && views[i].state == ViewState::kUsed ? clouds[i].size() : 0;
  }
  const std::size_t stride = total / std::max<std::size_t>(1, target_.capacity()) + 1;
  target_.clear();
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    const bool taken = i != without && views[i].state == ViewState::kUsed;
    for (std::size_t k = 0; taken && k < clouds[i].size(); k += stride) {
      const Eigen::Vector3f q = (views[i].T_base_camera * at(clouds[i], k)).cast<float>();
      (void)target_.append({q.x(), q.y(), q.z()});
    }
  }
  (void)index_->rebuild(target_.view());
}

void CloudSpliceChain::find_normals(double radius_mm) noexcept {
  const auto estimation = cloud::NormalEstimation::make(
      {.radius_mm = static_cast<float>(radius_mm), .min_neighbours = 6});
  if (estimation.ok()) {
    (void)estimation.value().run(*index_, {target_.view(), {}, {}}, {}, normals_);
  }
}

splice::Icp::Report CloudSpliceChain::refine(const cloud::CloudView& source,
                                             const RigidTransform& start,
                                             double gate_mm) const noexcept {
  splice::Icp::Config config;
  config.start_gate_mm = gate_mm;
  config.final_gate_mm = config_.tolerance_mm;
  config.stride = static_cast<std::uint32_t>(source.size() / target_.capacity() + 1);
  return splice::Icp(config).run(source, target_.view(), normals_.view(target_.size()), *index_,
                                 start);
}

// Across the surface, where noise is all that may part two clouds; along it, spacing is. Asked both
// ways: a cloud that lies on another but leaves bare what it should have seen is in the wrong
// place.
double CloudSpliceChain::agreement(const cloud::CloudView& source,
                                   const RigidTransform& T_target_source) const noexcept {
  const RigidTransform T_source_target = T_target_source.inverse();
  Agreement forth;
  for (std::size_t i = 0; i < source.size(); i += source.size() / kAsked + 1) {
    const Eigen::Vector3d p = T_target_source * at(source, i);
    const search::Neighbour near = nearest(*index_, p, kReachSpacings * scale_mm_);
    forth.add(near, near.index == search::kNoPoint ? 0.0 : off_plane_mm(p, near.index), noise_mm_);
  }
  Agreement back;
  for (std::size_t i = 0; i < target_.size(); i += target_.size() / kAsked + 1) {
    const Eigen::Vector3d p = T_source_target * at(target_.view(), i);
    const search::Neighbour near = nearest(*source_index_, p, kReachSpacings * scale_mm_);
    const bool found = near.index != search::kNoPoint;
    back.add(near, found ? off_plane_mm(T_target_source * at(source, near.index), i) : 0.0,
             noise_mm_);
  }
  return 0.5 * (forth.mean() + back.mean());
}

// Far where the target's point has no normal.
double CloudSpliceChain::off_plane_mm(const Eigen::Vector3d& p_target,
                                      std::size_t i) const noexcept {
  const geometry::Vec3f n = normals_[i];
  const Eigen::Vector3d normal(n.x, n.y, n.z);
  return normal.squaredNorm() > 0.5 ? normal.dot(p_target - at(target_.view(), i)) : 1e9;
}

bool CloudSpliceChain::place(std::span<const cloud::CloudView> clouds, std::size_t which,
                             Buffer<SplicedView>& out) noexcept {
  gather(clouds, out.view(), which);
  start_->set_target(target_.view(), *index_);
  const auto candidates = start_->run(clouds[which]);
  const auto samples = start_->samples();
  scale_mm_ = std::max(start_->noise_mm(), start_->spacing_mm());
  find_normals(kNormalRadius * scale_mm_);
  (void)source_index_->rebuild(clouds[which]);
  noise_mm_ = start_->noise_mm();
  const double apart_mm = 2.0 * config_.search.tolerance_mm;
  refined_.clear();
  for (const StartCandidate& candidate : candidates) {
    const auto icp = refine(clouds[which], candidate.T_a_b, config_.search.tolerance_mm);
    splice::enter_candidate(
        samples, {icp.T_target_source, score(clouds, out.view(), which, icp.T_target_source)},
        apart_mm, refined_);
  }
  CloudSpliceRow& row = rows_[which];
  row = {};
  if (refined_.empty()) {
    return false;
  }
  row.agreement = refined_[0].agreement;
  row.rival = refined_.size() > 1 ? refined_[1].agreement / std::max(row.agreement, 1e-9) : 0.0;
  const bool overlaps = row.agreement >= config_.min_agreement;
  out[which].state = !overlaps                       ? ViewState::kNoOverlap
                     : row.rival > config_.max_rival ? ViewState::kAmbiguous
                                                     : ViewState::kUsed;
  out[which].T_base_camera = refined_[0].T_a_b;
  if (out[which].state != ViewState::kUsed) {
    return false;
  }
  learn_senses(clouds, out.view(), which);
  return true;
}

double CloudSpliceChain::score(std::span<const cloud::CloudView> clouds,
                               std::span<const SplicedView> views, std::size_t which,
                               const RigidTransform& T_base_cloud) const noexcept {
  double sum = 0.0;
  double asked = 0.0;
  for (std::size_t k = 0; k < clouds.size(); ++k) {
    if (k == which || views[k].state != ViewState::kUsed) {
      continue;
    }
    const RigidTransform T_k_new = views[k].T_base_camera.inverse() * T_base_cloud;
    sum += fronts_[k].contradiction(fronts_[k].before(clouds[which], T_k_new)) +
           fronts_[which].contradiction(fronts_[which].before(clouds[k], T_k_new.inverse()));
    asked += 1.0;
  }
  return agreement(clouds[which], T_base_cloud) - kContradictionWeight * sum / std::max(asked, 1.0);
}

void CloudSpliceChain::learn_senses(std::span<const cloud::CloudView> clouds,
                                    std::span<const SplicedView> views,
                                    std::size_t which) noexcept {
  for (std::size_t k = 0; k < clouds.size(); ++k) {
    if (k != which && views[k].state == ViewState::kUsed) {
      const RigidTransform T_k_new = views[k].T_base_camera.inverse() * views[which].T_base_camera;
      fronts_[k].learn(fronts_[k].before(clouds[which], T_k_new));
      fronts_[which].learn(fronts_[which].before(clouds[k], T_k_new.inverse()));
    }
  }
}

void CloudSpliceChain::settle(std::span<const cloud::CloudView> clouds,
                              Buffer<SplicedView>& out) noexcept {
  const auto base = static_cast<std::size_t>(
      std::find_if(out.view().begin(), out.view().end(),
                   [](const SplicedView& view) { return view.state == ViewState::kUsed; }) -
      out.view().begin());
  for (std::uint32_t round = 0; round < config_.num_rounds; ++round) {
    for (std::size_t i = 0; i < clouds.size(); ++i) {
      gather(clouds, out.view(), i);
      if (out[i].state != ViewState::kUsed || target_.size() == 0) {
        continue;
      }
      find_normals(kNormalRadius * scale_mm_);
      const auto icp =
          refine(clouds[i], out[i].T_base_camera, config_.tolerance_mm + 2.0 * scale_mm_);
      out[i].T_base_camera = icp.T_target_source;
      out[i].covariance = icp.covariance;
      out[i].surface_rms_mm = icp.rms_mm;
      rows_[i].overlap = icp.overlap;
      rows_[i].rms_mm = icp.rms_mm;
      rows_[i].num_frozen = icp.observability.num_frozen;
    }
  }
  const RigidTransform T_base_common =
      base < out.size() ? out[base].T_base_camera.inverse() : RigidTransform{};
  for (SplicedView& view : out.items()) {
    view.T_base_camera = T_base_common * view.T_base_camera;
  }
}

}  // namespace dseam::pipeline
