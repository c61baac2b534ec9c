// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/joint/joint_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dseam/geometry/robust.hpp"
#include "dseam/seam/surface/surface_fit.hpp"

namespace dseam::seam {
namespace {

constexpr double kTurnRad = 2.0 * std::numbers::pi;
constexpr double kInnerSpacings = 2.0;
constexpr double kBandNoises = 40.0;  // Noise tilts a surface by 1 in 40 at most over the band.
constexpr double kPatchMm = 8.0;      // The length over which depth noise hangs together.
constexpr double kMinPatchWeight = 3.0;
constexpr double kFullPatchWeight = 8.0;
constexpr std::size_t kMinPoints = 60;
constexpr std::size_t kEnoughPoints = 40000;
constexpr std::size_t kEnoughToRefine = 4000;
constexpr double kBesideMm = 8.0;  // Within this every point counts: for coverage and edges.
constexpr int kRefinements = 3;
constexpr int kModelRounds = 3;
constexpr int kReselections = 4;
constexpr double kFarShare = 0.3;  // Of how far a point may lie off: a deviation that costs points.

}  // namespace

JointFit::JointFit(std::size_t max_points, Arena& arena) noexcept
    : scratch_(arena.take<float>(max_points / 2)),
      sums_(arena.take<PatchSum>(kMaxPatches)),
      patches_(arena.take<Patch>(kMaxPatches)) {
  shell_.points = Buffer<NearPoint>(arena.take<NearPoint>(max_points / 2));
  nozzle_.points = Buffer<NearPoint>(arena.take<NearPoint>(max_points / 2));
  shell_.residual = ResidualModel(arena);
  nozzle_.residual = ResidualModel(arena);
}

bool JointFit::run(const cloud::CloudView& cloud, const Joint& found,
                   const std::optional<Surface>& bore, const Scales& scales) noexcept {
  const auto [spacing_mm, noise_mm, tolerance_mm] = scales;
  joint_ = found;
  bore_ = bore;
  follows_model_ = false;
  band_mm_ = std::max(std::clamp(0.5 * found.nozzle.radius_mm, 12.0, 28.0) + 2.0 * spacing_mm,
                      kBandNoises * noise_mm);
  inner_mm_ = kInnerSpacings * spacing_mm;
  const double round = kTurnRad * found.nozzle.radius_mm / std::max(kPatchMm, 3.0 * spacing_mm);
  patches_round_ = static_cast<std::size_t>(std::clamp(round, 24.0, 120.0));
  for (int i = 0; i < 2; ++i) {
    select(cloud, i == 0 ? tolerance_mm : 1.5 * tolerance_mm);
    if (!refine(shell_, joint_.shell) || !refine(nozzle_, joint_.nozzle)) {
      return false;
    }
  }
  select(cloud, 1.5 * tolerance_mm);
  model(shell_, joint_.shell);
  model(nozzle_, joint_.nozzle);
  // The flanks of an oval nozzle lie farther off than a point may. What is seen of them tells more
  // of them, and so on.
  follows_model_ = true;
  for (int i = 0; i < kReselections && nozzle_.fitted && deviates(kFarShare * tolerance_mm); ++i) {
    select(cloud, 1.5 * tolerance_mm);
    model(shell_, joint_.shell);
    model(nozzle_, joint_.nozzle);
  }
  return shell_.fitted && nozzle_.fitted;
}

bool JointFit::deviates(double limit_mm) const noexcept {
  constexpr int kAngles = 36;
  constexpr double kAway = 0.3;
  for (int i = 0; i < kAngles; ++i) {
    const double phi_rad = kTurnRad * i / kAngles;
    const auto root = root_at(joint_, frame_, phi_rad);
    if (root && std::abs(nozzle_.residual.at(*root, phi_rad, kAway)) > limit_mm) {
      return true;
    }
  }
  return false;
}

// All points beside the joint, and of those farther off as many as the surfaces need.
void JointFit::select(const cloud::CloudView& cloud, double tolerance_mm) noexcept {
  frame_ = frame_of(joint_.nozzle);
  pivot_ = joint_.nozzle.point;
  shell_.points.clear();
  nozzle_.points.clear();
  num_dropped_ = 0;
  const std::size_t enough = std::min(kEnoughPoints, std::max<std::size_t>(1, scratch_.size()));
  const std::size_t stride = 1 + cloud.size() / enough;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d p(cloud.x[i], cloud.y[i], cloud.z[i]);
    const double off_cylinder = signed_distance(joint_.nozzle, p);
    const bool to_model = follows_model_ && std::abs(off_cylinder) < band_mm_;
    const double outside = to_model ? outside_nozzle(p) : off_cylinder;
    if (!(outside > -tolerance_mm && outside < band_mm_) ||
        (outside > kBesideMm && i % stride != 0)) {
      continue;
    }
    const double above = shell_distance(joint_, p);
    const bool on_shell = std::abs(above) < tolerance_mm && outside > 0.0;
    const bool on_nozzle = outside < tolerance_mm && above > 0.0 && above < band_mm_ &&
                           (above < kBesideMm || i % stride == 0) && !in_bore(p, outside);
    if ((!on_shell && !on_nozzle) || shell_normal(joint_, p).dot(joint_.nozzle.axis) < -0.1) {
      continue;  // Not near, or where the nozzle's axis leaves the shell on the other side.
    }
    add(p, outside, above, on_shell && (!on_nozzle || outside > above));
  }
}

bool JointFit::in_bore(const Eigen::Vector3d& p, double outside) const noexcept {
  return outside < 0.0 && bore_ && std::abs(signed_distance(*bore_, p)) < -outside;
}

void JointFit::add(const Eigen::Vector3d& p, double outside, double above, bool to_shell) noexcept {
  NearPoint near;
  near.from_pivot = (p - pivot_).cast<float>();
  near.phi_rad = angle_about(joint_.nozzle, frame_, p);
  near.away_mm = to_shell ? outside : above;
  near.distance_mm = to_shell ? joint_.shell_sign * above : outside;
  near.rest_mm = near.distance_mm;
  num_dropped_ += (to_shell ? shell_ : nozzle_).points.append(near) ? 0U : 1U;
}

// The robust cut from the residuals of the points clear of the joint; 0 where they are few.
double JointFit::cut_of(const Side& side) noexcept {
  std::size_t n = 0;
  for (const NearPoint& q : side.points.view()) {
    if (q.away_mm > inner_mm_) {
      scratch_[n++] = static_cast<float>(std::abs(q.rest_mm));
    }
  }
  return n < kMinPoints ? 0.0 : geometry::tukey_cut_mm(scratch_.first(n));
}

// Distances from the surface, and what the residual's model leaves of them.
void JointFit::measure(Side& side, const Surface& surface) const noexcept {
  for (NearPoint& q : side.points.items()) {
    const Eigen::Vector3d p = pivot_ + q.from_pivot.cast<double>();
    q.distance_mm = signed_distance(surface, p);
    q.rest_mm = q.distance_mm - side.residual.at(p, q.phi_rad, q.away_mm / band_mm_);
  }
}

bool JointFit::refine(Side& side, Surface& surface) noexcept {
  side.residual.reset(surface);
  const std::size_t stride = 1 + side.points.size() / kEnoughToRefine;
  for (int i = 0; i < kRefinements; ++i) {
    const double cut = cut_of(side);
    if (cut == 0.0) {
      return false;
    }
    SurfaceEquations equations(surface);
    for (std::size_t k = 0; k < side.points.size(); k += stride) {
      const NearPoint& q = side.points[k];
      const double weight = q.away_mm > inner_mm_ ? geometry::tukey(q.distance_mm / cut) : 0.0;
      if (weight > 0.0) {
        equations.add(pivot_ + q.from_pivot.cast<double>(), weight);
      }
    }
    const std::optional<Surface> next = equations.solve();
    if (!next) {
      return false;
    }
    surface = *next;
    measure(side, surface);
  }
  return true;
}

// The model's parameters and its deviations are found together; what belongs to the parameters
// then moves the surface, so that an oval nozzle's axis is its own.
void JointFit::model(Side& side, Surface& surface) noexcept {
  side.residual.reset(surface);
  side.fitted = false;
  measure(side, surface);
  const PatchGrid grid{patches_round_,
                       kTurnRad * joint_.nozzle.radius_mm / static_cast<double>(patches_round_),
                       (band_mm_ - inner_mm_) / double{kPatchesAway}};
  for (int round = 0; round < kModelRounds; ++round) {
    const double cut = cut_of(side);
    const std::size_t count = collect_patches(side, cut);
    side.fitted = cut > 0.0 && side.residual.fit(patches_.first(count), grid);
    if (!side.fitted) {
      return;
    }
    if (&side == &nozzle_ && round + 1 < kModelRounds) {  // Seen all round, unlike the shell.
      surface = side.residual.move_into(surface);
    }
    measure(side, surface);
  }
  const double cut = cut_of(side);
  for (NearPoint& q : side.points.items()) {
    q.trusted = std::abs(q.rest_mm) < cut;
  }
}

std::size_t JointFit::collect_patches(const Side& side, double cut_mm) noexcept {
  const std::size_t used = patches_round_ * kPatchesAway;
  std::fill_n(sums_.begin(), used, PatchSum{});
  const double width = (band_mm_ - inner_mm_) / double{kPatchesAway};
  for (const NearPoint& q : side.points.view()) {
    const double weight = q.away_mm > inner_mm_ ? geometry::tukey(q.rest_mm / cut_mm) : 0.0;
    if (!(weight > 0.0)) {
      continue;
    }
    const double turn = (q.phi_rad / kTurnRad + 0.5) * static_cast<double>(patches_round_);
    const auto column = std::min(static_cast<std::size_t>(std::max(0.0, turn)), patches_round_ - 1);
    const auto row =
        std::min(static_cast<std::size_t>((q.away_mm - inner_mm_) / width), kPatchesAway - 1);
    PatchSum& sum = sums_[row * patches_round_ + column];
    sum.point += weight * (pivot_ + q.from_pivot.cast<double>());
    sum.away += weight * q.away_mm / band_mm_;
    sum.distance += weight * q.distance_mm;
    sum.weight += weight;
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < used; ++i) {
    const PatchSum& s = sums_[i];
    if (s.weight >= kMinPatchWeight) {
      const Eigen::Vector3d mean = s.point / s.weight;
      patches_[count++] = {mean,
                           angle_about(joint_.nozzle, frame_, mean),
                           s.away / s.weight,
                           s.distance / s.weight,
                           std::min(1.0, s.weight / kFullPatchWeight),
                           i};
    }
  }
  return count;
}

double JointFit::above_shell(const Eigen::Vector3d& p) const noexcept {
  const double away = signed_distance(joint_.nozzle, p) / band_mm_;
  const double phi = angle_about(joint_.nozzle, frame_, p);
  return joint_.shell_sign * (signed_distance(joint_.shell, p) - shell_.residual.at(p, phi, away));
}

double JointFit::outside_nozzle(const Eigen::Vector3d& p) const noexcept {
  const double away = shell_distance(joint_, p) / band_mm_;
  const double phi = angle_about(joint_.nozzle, frame_, p);
  return signed_distance(joint_.nozzle, p) - nozzle_.residual.at(p, phi, away);
}

double JointFit::shell_variance(const Eigen::Vector3d& p) const noexcept {
  const double away = signed_distance(joint_.nozzle, p) / band_mm_;
  return shell_.residual.variance_at(p, angle_about(joint_.nozzle, frame_, p), away);
}

double JointFit::nozzle_variance(const Eigen::Vector3d& p) const noexcept {
  const double away = shell_distance(joint_, p) / band_mm_;
  return nozzle_.residual.variance_at(p, angle_about(joint_.nozzle, frame_, p), away);
}

ResidualModel::Row JointFit::nozzle_errors(const Eigen::Vector3d& p) const noexcept {
  const double away = shell_distance(joint_, p) / band_mm_;
  return nozzle_.residual.errors_at(p, angle_about(joint_.nozzle, frame_, p), away);
}

}  // namespace dseam::seam
