// SPDX-License-Identifier: Apache-2.0
#include "splice/network/network_adjustment.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace dseam::splice {
namespace {

using geometry::Matrix6;
using geometry::RigidTransform;
using geometry::Vector6;

constexpr double kPatchSigmaMm = 0.03;     // Before the residuals tell, and
constexpr double kTiesPerIndependent = 4;  // likewise.
constexpr double kSmallestSigmaMm = 0.004;

// A left perturbation about `pivot`.
RigidTransform moved(const RigidTransform& pose, const Vector6& delta,
                     const Eigen::Vector3d& pivot) noexcept {
  const Eigen::Matrix3d turn = geometry::rotation_exp(delta.tail<3>());
  return {turn * pose.rotation, turn * (pose.translation_mm - pivot) + pivot + delta.head<3>()};
}

bool same_frame(const PatchField& a, const PatchField& b) noexcept {
  return a.patches.size() == b.patches.size() &&
         std::equal(a.patches.begin(), a.patches.end(), b.patches.begin(),
                    [](const SurfacePatch& p, const SurfacePatch& q) {
                      return p.num_pixels == q.num_pixels && p.q == q.q;
                    });
}

bool has_surface(const PatchField& field) noexcept {
  return std::any_of(field.patches.begin(), field.patches.end(),
                     [](const SurfacePatch& p) { return p.num_pixels > 0; });
}

}  // namespace

void Adjustment::take_in() noexcept {
  std::fill(joint.cells.begin(), joint.cells.end(), 0.0);
  std::fill(tied.begin(), tied.end(), Matrix6(Matrix6::Identity()));
  out.clear();
  out.resize(inputs.size());
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    views[v].field = inputs[v].field;
    views[v].place(inputs[v].start_T_base_camera);
    out[v] = {};
    out[v].T_base_camera = inputs[v].start_T_base_camera;
    const bool sees = has_surface(inputs[v].field);
    out[v].state = sees ? ViewState::kNoOverlap : ViewState::kEmpty;
    views[v].used = sees && inputs[v].placed;
    for (std::size_t earlier = 0; earlier < v; ++earlier) {
      if (views[v].used && same_frame(inputs[v].field, inputs[earlier].field)) {
        views[v].used = false;
        out[v].state = ViewState::kDuplicate;
      }
    }
  }
}

// Turns act about the middle of what is seen, where their effect on residuals is small.
void Adjustment::choose_pivot() noexcept {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double squares = 0.0;
  double count = 0.0;
  for (const PosedView& view : views) {
    for (std::uint32_t row = 0; view.used && row < view.field.rows; row += 8) {
      for (std::uint32_t column = 0; column < view.field.columns; column += 8) {
        const Eigen::Vector2d c = view.field.centre_px(column, row);
        const SurfacePoint s = surface_at(view.field, c.x(), c.y());
        sum += s.valid ? Eigen::Vector3d(view.T_base_camera * s.p_camera) : Eigen::Vector3d::Zero();
        squares += s.valid ? (view.T_base_camera * s.p_camera).squaredNorm() : 0.0;
        count += s.valid ? 1.0 : 0.0;
      }
    }
  }
  pivot = count > 0.0 ? Eigen::Vector3d(sum / count) : sum;
  reach_mm = count > 0.0 ? std::sqrt(std::max(0.0, squares / count - pivot.squaredNorm())) : 0.0;
}

// The start may stand in the frame of one wrong report: take the one that most others agree with.
void Adjustment::vote_on_base() noexcept {
  double best = -1.0;
  RigidTransform shift;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    if (!views[k].used || !inputs[k].reported.known) {
      continue;
    }
    const RigidTransform candidate = inputs[k].reported.T_base_camera * views[k].T_camera_base;
    double votes = 0.0;
    for (std::size_t v = 0; v < inputs.size(); ++v) {
      if (views[v].used && inputs[v].reported.known) {
        const auto r = reported_residual(candidate * views[v].T_base_camera,
                                         inputs[v].reported.T_base_camera, config);
        votes += 1.0 / (1.0 + r.chi_squared / kReportedChiSquaredLimit);
      }
    }
    if (votes > best) {
      best = votes;
      shift = candidate;
    }
  }
  for (PosedView& view : views) {
    view.place(shift * view.T_base_camera);
  }
  report.has_base = best > 0.0;
}

void Adjustment::add_reports() noexcept {
  bool anchored = report.has_base;
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    if (!views[v].used) {
      // Unknowns of a view that is left out: held where they are.
      system.add(6 * v, 6 * v, Matrix6::Identity());
      continue;
    }
    if (inputs[v].reported.known) {
      add_reported_tie(views[v].T_base_camera, inputs[v].reported.T_base_camera, pivot, config,
                       6 * v, system);
    }
    if (!anchored) {
      constexpr double kHeld = 1e13;  // All that pulls at a view together comes to 1e8.
      system.add(6 * v, 6 * v, Matrix6(kHeld * Matrix6::Identity()));
      anchored = true;
    }
  }
  const double bowl_weight = 1.0 / (config.bowl_sigma_mm * config.bowl_sigma_mm);
  system.add(bowl_at(), bowl_at(), Eigen::Matrix2d(bowl_weight * Eigen::Matrix2d::Identity()));
  system.add_gradient(bowl_at(), Eigen::Vector2d(bowl_weight * report.bowl_mm));
}

void Adjustment::assemble_ties(bool without_noise,
                               const std::array<double, kFacings>& spread) noexcept {
  system.reset(bowl_at() + 2);
  surface = {};
  markers = {};
  const double variance = sigma_mm * sigma_mm * ties_per_independent;
  const SurfaceTieConfig ties{gate_mm, config.start_gate_mm, 1.0 / variance, without_noise, spread};
  report.num_surface_ties =
      add_surface_ties(views, pivot, report.bowl_mm, ties, bowl_at(), system, surface);
  add_marker_ties(views, sights, pivot, report.bowl_mm, marker_variance_factor, bowl_at(), system,
                  markers);
}

void Adjustment::assemble(bool without_noise, const std::array<double, kFacings>& spread) noexcept {
  assemble_ties(without_noise, spread);
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    system.project(6 * v, tied[v]);
  }
  add_reports();
}

double Adjustment::step() noexcept {
  assemble(false);
  if (!system.factorise()) {
    report.state = NetworkState::kSingular;
    return 0.0;
  }
  system.solve();
  double largest = 0.0;
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    const Vector6 delta = Eigen::Map<const Vector6>(system.step().data() + 6 * v);
    if (views[v].used) {
      views[v].place(moved(views[v].T_base_camera, delta, pivot));
      largest = std::max(largest, delta.head<3>().norm() + 100.0 * delta.tail<3>().norm());
    }
  }
  report.bowl_mm += Eigen::Map<const Eigen::Vector2d>(system.step().data() + bowl_at());
  decrement = system.decrement();
  return largest;
}

// Sights that contradict each other are worse than predicted; that they agree does not make them
// better, since what they have in common cannot be seen in them.
void Adjustment::settle_marker_variance() noexcept {
  constexpr double kMinFreedom = 12.0;
  if (markers.freedom >= kMinFreedom) {
    const double found = marker_variance_factor * markers.chi_squared / markers.freedom;
    marker_variance_factor = std::clamp(found, 1.0, 1e4);
  }
}

// The weights follow the residuals. True when those just used were those the residuals ask for.
bool Adjustment::settle_weights() noexcept {
  constexpr double kSame = 0.1;
  const double before = sigma_mm * sigma_mm * ties_per_independent;
  const double markers_before = marker_variance_factor;
  const TieResiduals residuals = surface.residuals();
  sigma_mm = std::max(kSmallestSigmaMm, std::sqrt(residuals.variance_mm2()));
  ties_per_independent = residuals.ties_per_independent();
  settle_marker_variance();
  const double now = sigma_mm * sigma_mm * ties_per_independent;
  return std::abs(now - before) < kSame * before &&
         std::abs(marker_variance_factor - markers_before) < kSame * markers_before;
}

void Adjustment::adjust() noexcept {
  constexpr double kSettledMm = 2e-4;
  constexpr double kSettledSigmas = 0.05;
  gate_mm = config.start_gate_mm;
  report.state = NetworkState::kNotConverged;
  sigma_mm = kPatchSigmaMm;
  ties_per_independent = kTiesPerIndependent;
  marker_variance_factor = 1.0;
  for (report.iterations = 1; report.iterations <= config.max_iterations; ++report.iterations) {
    const double largest = step();
    if (report.state == NetworkState::kSingular) {
      return;
    }
    const double final_gate =
        std::max(config.final_gate_mm, 6.0 * std::sqrt(surface.residuals().variance_mm2()));
    const bool at_last_gate = gate_mm <= config.final_gate_mm || gate_mm <= 1.01 * final_gate;
    // Where the surfaces leave a direction to the reports, ties that come and go keep the last step
    // above any fixed length: then it is enough that it is small beside its own sigma.
    const double settled_decrement =
        kSettledSigmas * kSettledSigmas * 6.0 * static_cast<double>(num_used());
    const bool settled = largest < kSettledMm || decrement < settled_decrement;
    if (at_last_gate && settle_weights() && settled) {
      report.state = NetworkState::kAdjusted;
      return;
    }
    gate_mm = std::max(std::min(0.5 * gate_mm, std::max(4.0 * largest, final_gate)),
                       config.final_gate_mm);
  }
}

void Adjustment::leave_out(std::size_t v, ViewState why) noexcept {
  views[v].used = false;
  out[v].state = why;
}

// A view whose surface lies apart from the others' where they overlap.
bool Adjustment::leave_out_worst() noexcept {
  double worst = config.min_share_near;
  std::size_t which = inputs.size();
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    if (views[v].used && surface.wide[v] > 0) {
      const double share = static_cast<double>(surface.near[v]) / surface.wide[v];
      if (share < worst) {
        worst = share;
        which = v;
      }
    }
  }
  if (which == inputs.size()) {
    return false;
  }
  // Of two that disagree nobody can say which one is right.
  const bool both = num_used() <= 2;
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    if (views[v].used && (both || v == which)) {
      leave_out(v, ViewState::kContradicts);
    }
  }
  return !both;
}

// Only the largest set of views that hang together is one workpiece.
bool Adjustment::leave_out_unlinked() noexcept {
  bool any = false;
  std::uint32_t best = 0;
  for (std::size_t start = 0; start < inputs.size(); ++start) {
    if (!views[start].used) {
      continue;
    }
    std::uint32_t reached = 1U << start;
    for (std::size_t round = 0; round < inputs.size(); ++round) {
      for (std::size_t v = 0; v < inputs.size(); ++v) {
        reached |= (reached >> v) & 1U ? surface.linked[v] | markers.linked[v] : 0U;
      }
    }
    best = std::popcount(reached) > std::popcount(best) ? reached : best;
  }
  for (std::size_t v = 0; v < inputs.size(); ++v) {
    if (views[v].used && ((best >> v) & 1U) == 0U) {
      leave_out(v, ViewState::kNoOverlap);
      any = true;
    }
  }
  return any;
}

}  // namespace dseam::splice
