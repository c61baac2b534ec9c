// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/pipes/pipe_finder.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "splice/pipes/pipe_form.hpp"

namespace dseam::splice {
namespace {

using geometry::Cylinder;

constexpr std::uint32_t kFewestPatches = 10;  // That make a pipe: it has seven unknowns.
constexpr std::size_t kVoters = 512;          // Samples that a trial is judged by.
constexpr double kMinTurn = 0.25;             // Between two normals that make a cylinder, rad,
constexpr double kMaxTurn = 1.2;              // and at most.
constexpr double kAxisError = 0.02;           // Of an axis from two normals.
constexpr double kLoose = 2.0;                // Before a cylinder is fitted, against afterwards.
constexpr int kMaxAttempts = 6;               // Cylinders that do not hold when they are fitted.

// Every how manieth row and column: as far apart along the rows as across.
std::uint32_t stride_for(const PatchField& field) noexcept {
  const auto smooth = std::count_if(field.patches.begin(), field.patches.end(),
                                    [](const SurfacePatch& p) { return p.num_pixels > 0; });
  std::uint32_t stride = 1;
  while (std::size_t{stride} * stride * PipeFinder::kMaxSamples <
         static_cast<std::size_t>(smooth)) {
    ++stride;
  }
  return stride;
}

// The nozzle's axis is to point away from the shell's.
void turn_outwards(const Cylinder& shell, Pipe& pipe) noexcept {
  geometry::CylinderFit& nozzle = pipe.fit;
  Eigen::Vector3d out = nozzle.cylinder.point_mm - shell.point_mm;
  out -= shell.axis * shell.axis.dot(out);
  if (nozzle.cylinder.axis.dot(out) < 0.0) {
    nozzle.cylinder.axis = -nozzle.cylinder.axis;
    nozzle.e2 = -nozzle.e2;
    Eigen::Matrix<double, 5, 1> sense;
    sense << 1.0, -1.0, -1.0, 1.0, 1.0;
    nozzle.covariance = sense.asDiagonal() * nozzle.covariance * sense.asDiagonal();
    pipe.depth_effect = sense.asDiagonal() * pipe.depth_effect;
  }
}

}  // namespace

void PipeFinder::Coordinates::set(std::size_t i, const Eigen::Vector3d& v) noexcept {
  x[i] = static_cast<float>(v.x());
  y[i] = static_cast<float>(v.y());
  z[i] = static_cast<float>(v.z());
}

Result<PipeFinder> PipeFinder::make(const Config& config, Arena& arena) noexcept {
  if (!(config.tolerance_mm > 0.0) || !(config.min_radius_mm > 0.0) ||
      !(config.max_radius_mm > config.min_radius_mm) || !(config.ovality_sigma_mm > 0.0) ||
      config.min_patches < kFewestPatches) {
    return Errc::kInvalidArgument;
  }
  PipeFinder finder(config);
  for (Coordinates* c : {&finder.points_, &finder.normals_, &finder.chosen_}) {
    *c = {arena.take<float>(kMaxSamples), arena.take<float>(kMaxSamples),
          arena.take<float>(kMaxSamples)};
  }
  finder.aside_ = arena.take<bool>(kMaxSamples);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return finder;
}

void PipeFinder::sample(const PatchField& field) noexcept {
  const std::uint32_t stride = stride_for(field);
  num_samples_ = 0;
  for (std::uint32_t row = 0; row < field.rows; row += stride) {
    for (std::uint32_t column = 0; column < field.columns; column += stride) {
      const Eigen::Vector2d c = field.centre_px(column, row);
      const SurfacePoint s = surface_at(field, c.x(), c.y());
      if (s.valid && num_samples_ < kMaxSamples) {
        points_.set(num_samples_, s.p_camera);
        normals_.set(num_samples_, s.n_camera);
        aside_[num_samples_++] = false;
      }
    }
  }
}

// Where both normals cross in the plane across the axis.
bool PipeFinder::trial(Pcg32& random, Cylinder& out) const noexcept {
  const auto n = static_cast<std::uint32_t>(num_samples_);
  const std::size_t i = random.below(n);
  // Neighbours in the image's rows are more often on the same pipe.
  const std::size_t k =
      (random.next() & 1U) != 0U ? random.below(n) : (i + random.below(n / 8)) % n;
  if (aside_[i] || aside_[k]) {
    return false;
  }
  const Eigen::Vector3d a = normals_.first(n)[i];
  const Eigen::Vector3d b = normals_.first(n)[k];
  const Eigen::Vector3d across = a.cross(b);
  const double sine = across.norm();
  if (sine < std::sin(kMinTurn) || sine > std::sin(kMaxTurn) || a.dot(b) < 0.0) {
    return false;
  }
  out.axis = across / sine;
  Eigen::Vector3d between = points_.first(n)[i] - points_.first(n)[k];
  const double along = out.axis.dot(between);
  between -= out.axis * along;
  const double radius_mm = between.dot(a - b) / (a - b).squaredNorm();
  out.radius_mm = facing_ * radius_mm;
  out.point_mm = points_.first(n)[i] - radius_mm * a;
  const double tolerance = config_.tolerance_mm + kAxisError * std::abs(along);
  return out.radius_mm > config_.min_radius_mm && out.radius_mm < config_.max_radius_mm &&
         (between - radius_mm * (a - b)).norm() < tolerance;
}

bool PipeFinder::lies_on(const Cylinder& c, std::size_t i, double tolerance_mm,
                         double cosine) const noexcept {
  const Eigen::Vector3d p = points_.first(num_samples_)[i];
  return std::abs(c.distance_mm(p)) < tolerance_mm &&
         facing_ * c.normal(p).dot(normals_.first(num_samples_)[i]) > cosine;
}

std::uint32_t PipeFinder::votes(const Cylinder& c, std::size_t stride) const noexcept {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < num_samples_; i += stride) {
    count +=
        !aside_[i] && lies_on(c, i, kLoose * config_.tolerance_mm, config_.min_cosine) ? 1U : 0U;
  }
  return count;
}

bool PipeFinder::best_trial(Cylinder& best) noexcept {
  const std::size_t stride = 1 + num_samples_ / kVoters;
  Pcg32 random(num_samples_);
  std::uint32_t most = 0;
  std::uint32_t judged = 0;
  for (std::uint32_t draw = 0; draw < kDraws && judged < kTrials; ++draw) {
    Cylinder c;
    if (!trial(random, c)) {
      continue;
    }
    ++judged;
    const std::uint32_t count = votes(c, stride);
    if (count > most) {
      most = count;
      best = c;
    }
  }
  return most * stride >= config_.min_patches / 2 && votes(best, 1) >= config_.min_patches;
}

std::size_t PipeFinder::collect(const Cylinder& c, double tolerance_mm, double cosine) noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < num_samples_; ++i) {
    if (!aside_[i] && lies_on(c, i, tolerance_mm, cosine)) {
      chosen_.set(count++, points_.first(num_samples_)[i]);
    }
  }
  return count;
}

void PipeFinder::put_aside(const Cylinder& c) noexcept {
  constexpr double kLooseCosine = 0.9;
  for (std::size_t i = 0; i < num_samples_; ++i) {
    aside_[i] = aside_[i] || lies_on(c, i, kLoose * config_.tolerance_mm, kLooseCosine);
  }
}

// Wide enough at first for an oval section; what turns out round is fitted once more.
bool PipeFinder::fit(const depth::Intrinsics& k, const Cylinder& start, Pipe& pipe) noexcept {
  geometry::SurfaceFitConfig config;
  config.start_gate_mm = 3.0 * config_.tolerance_mm;
  config.final_gate_mm = 0.5 * config_.tolerance_mm;
  config.min_points = config_.min_patches;
  config.min_radius_mm = config_.min_radius_mm;
  config.max_radius_mm = config_.max_radius_mm;
  pipe.fit.cylinder = start;
  std::size_t n = 0;
  for (int round = 0; round < 2; ++round) {
    n = collect(pipe.fit.cylinder, config.start_gate_mm, config_.min_cosine);
    pipe.fit = geometry::fit_cylinder(chosen_.first(n), pipe.fit.cylinder, config);
    if (pipe.fit.state != geometry::FitState::kConverged) {
      return false;
    }
  }
  settle_form(chosen_.first(n), k, config_.ovality_sigma_mm, pipe);
  return pipe.fit.state == geometry::FitState::kConverged;
}

// What does not hold when it is fitted is put aside as well, and the next is tried.
bool PipeFinder::next_pipe(const depth::Intrinsics& k, Pipe& pipe) noexcept {
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    Cylinder start;
    if (num_samples_ < config_.min_patches || !best_trial(start)) {
      return false;
    }
    const bool holds = fit(k, start, pipe);
    put_aside(holds ? pipe.fit.cylinder : start);
    if (holds) {
      return true;
    }
  }
  return false;
}

PipePairState PipeFinder::judge(const Pipe& pipe) const noexcept {
  if (pipe.ovality_mm > config_.max_ovality_mm || pipe.fit.rms_mm > config_.max_rms_mm) {
    return PipePairState::kNotRound;
  }
  const auto& variance = pipe.fit.covariance.diagonal();
  const bool known = std::sqrt(variance.head<2>().sum()) < config_.max_shift_sigma_mm &&
                     std::sqrt(variance.segment<2>(2).sum()) < config_.max_tilt_sigma_rad &&
                     std::sqrt(variance(4)) < config_.max_shift_sigma_mm;
  return known ? PipePairState::kFound : PipePairState::kTooNarrow;
}

// Says of the other pipe whether it makes a pair with the shell.
PipePairState PipeFinder::judge(const Pipe& shell, Pipe& other) const noexcept {
  const Cylinder& a = shell.fit.cylinder;
  const Cylinder& b = other.fit.cylinder;
  if (a.axis.cross(b.axis).norm() < config_.min_axis_sine) {
    return PipePairState::kParallel;
  }
  for (const Pipe* pipe : {&shell, &std::as_const(other)}) {
    if (const PipePairState state = judge(*pipe); state != PipePairState::kFound) {
      return state;
    }
  }
  other.usable = a.radius_mm - b.radius_mm > config_.min_lead_mm;
  return other.usable ? PipePairState::kFound : PipePairState::kAlike;
}

// The shell, and the nozzle where its outside is seen.
PipePairState PipeFinder::seek_outsides(const depth::Intrinsics& k, PipePair& pair) noexcept {
  facing_ = 1.0;
  if (!next_pipe(k, pair.shell)) {
    return PipePairState::kNoPipe;
  }
  pair.nozzle.patches_per_independent = pair.shell.patches_per_independent;
  if (!next_pipe(k, pair.nozzle)) {
    return PipePairState::kOnePipe;
  }
  const double least = std::min(pair.shell.fit.num_inliers, pair.nozzle.fit.num_inliers);
  Pipe third;
  if (next_pipe(k, third) && third.fit.num_inliers > config_.rival_share * least) {
    return PipePairState::kMorePipes;
  }
  if (pair.shell.fit.cylinder.radius_mm < pair.nozzle.fit.cylinder.radius_mm) {
    std::swap(pair.shell, pair.nozzle);
  }
  turn_outwards(pair.shell.fit.cylinder, pair.nozzle);
  return judge(pair.shell, pair.nozzle);
}

// The nozzle's inside; that of the shell may be seen through it.
PipePairState PipeFinder::seek_bore(const depth::Intrinsics& k, PipePair& pair) noexcept {
  constexpr int kMaxInsides = 3;
  facing_ = -1.0;
  PipePairState state = PipePairState::kOnePipe;
  for (int i = 0; i < kMaxInsides && state != PipePairState::kFound; ++i) {
    pair.bore = {};
    pair.bore.patches_per_independent = pair.shell.patches_per_independent;
    if (!next_pipe(k, pair.bore)) {
      return state;
    }
    turn_outwards(pair.shell.fit.cylinder, pair.bore);
    state = judge(pair.shell, pair.bore);
  }
  return state;
}

PipePair PipeFinder::run(const PatchField& field) noexcept {
  PipePair pair;
  sample(field);
  pair.state = seek_outsides(field.intrinsics, pair);
  const bool nozzle_missing =
      pair.state == PipePairState::kOnePipe || pair.state == PipePairState::kTooNarrow;
  if (nozzle_missing || pair.nozzle.usable) {
    const PipePairState bore = seek_bore(field.intrinsics, pair);
    pair.state = bore == PipePairState::kFound ? bore : pair.state;
  }
  return pair;
}

}  // namespace dseam::splice
