// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/truth.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "shape/joint_geometry.hpp"

namespace dseam::hal::sim {
namespace {

using Eigen::Vector3d;
using seam::ReferenceCurve;

constexpr double kStepMm = 0.5;
constexpr double kTurn = 2.0 * std::numbers::pi;

void set_normals(TruthPoint& point, const Vector3d& n_shell, const Vector3d& n_nozzle) {
  point.n_shell = n_shell;
  point.n_nozzle = n_nozzle;
  point.dihedral_rad =
      std::numbers::pi - std::atan2(n_shell.cross(n_nozzle).norm(), n_shell.dot(n_nozzle));
}

/// One closed reference curve as a function of the angle round the nozzle.
class ClosedCurve {
 public:
  ClosedCurve(const JointConfig& joint, ReferenceCurve reference)
      : reference_(reference),
        shell_(shell_surface(joint)),
        nozzle_(nozzle_side(joint)),
        edge_shell_(shell_),
        edge_side_(joint.kind == JointKind::kSetIn ? hole_side(joint) : nozzle_side(joint)) {
    if (reference == ReferenceCurve::kNozzleEdge) {
      edge_shell_ = shell_.grown(joint.gap_mm);
    }
  }

  [[nodiscard]] std::optional<TruthPoint> at(double phi_rad) const {
    if (reference_ == ReferenceCurve::kGapMiddle) {
      return middle(phi_rad);
    }
    const bool root = reference_ == ReferenceCurve::kRoot;
    return root ? on(nozzle_, shell_, phi_rad) : on(edge_side_, edge_shell_, phi_rad);
  }

 private:
  /// The curve in which a side and a shell meet; its tangent is where both normals are crossed.
  [[nodiscard]] std::optional<TruthPoint> on(const Lateral& side, const ShellSurface& shell,
                                             double phi_rad) const {
    const auto p = joint_point(side, shell, phi_rad);
    if (!p) {
      return std::nullopt;
    }
    TruthPoint point;
    point.p = *p;
    const Vector3d n_shell = shell.normal(*p);
    point.tangent = n_shell.cross(side.normal(*p)).normalized();
    set_normals(point, n_shell, nozzle_.normal(nozzle_point(*p)));
    return point;
  }

  /// The nozzle's point at the same angle and height; the hole's wall is a gap away from it.
  [[nodiscard]] Vector3d nozzle_point(const Vector3d& p) const {
    const Vector3d local = nozzle_.axes.transpose() * (p - nozzle_.centre);
    const double phi = std::atan2(local.y() / nozzle_.b, local.x() / nozzle_.a);
    const Ray ruling = nozzle_.ruling(phi);
    return ruling.origin + local.z() * ruling.direction;
  }

  /// Halfway between the root and the shell's edge in the plane normal to the root.
  [[nodiscard]] std::optional<TruthPoint> middle(double phi_rad) const {
    constexpr int kSteps = 20;
    const auto root = on(nozzle_, shell_, phi_rad);
    double edge_phi = phi_rad;
    auto edge = on(edge_side_, shell_, edge_phi);
    for (int i = 0; root && edge && i < kSteps; ++i) {
      const double ahead = root->tangent.dot(edge->p - root->p);
      edge_phi -= ahead / (edge_side_.a * root->tangent.dot(edge->tangent));
      edge = on(edge_side_, shell_, edge_phi);
    }
    if (!root || !edge) {
      return std::nullopt;
    }
    TruthPoint point = *root;
    point.p = 0.5 * (root->p + edge->p);
    point.tangent = (root->tangent + edge->tangent).normalized();
    set_normals(point, (root->n_shell + edge->n_shell).normalized(), root->n_nozzle);
    return point;
  }

  ReferenceCurve reference_;
  ShellSurface shell_;
  Lateral nozzle_;
  ShellSurface edge_shell_;
  Lateral edge_side_;
};

/// Arc length against angle, by chords short enough that their sagitta does not count (1e-8 mm).
std::optional<std::vector<double>> arc_lengths(const ClosedCurve& curve, int num_steps) {
  std::vector<double> lengths{0.0};
  auto last = curve.at(0.0);
  for (int i = 1; last && i <= num_steps; ++i) {
    const auto next = curve.at(kTurn * i / num_steps);
    if (!next) {
      return std::nullopt;
    }
    lengths.push_back(lengths.back() + (next->p - last->p).norm());
    last = next;
  }
  return last ? std::optional(lengths) : std::nullopt;
}

std::optional<TruthCurve> sample_closed(const JointConfig& joint, ReferenceCurve reference) {
  constexpr int kFine = 36000;
  const ClosedCurve curve(joint, reference);
  const auto lengths = arc_lengths(curve, kFine);
  if (!lengths) {
    return std::nullopt;
  }
  TruthCurve out;
  out.length_mm = lengths->back();
  const auto count = static_cast<std::size_t>(std::ceil(out.length_mm / kStepMm));
  std::size_t below = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = out.length_mm * static_cast<double>(i) / static_cast<double>(count);
    while (below + 1 < lengths->size() && (*lengths)[below + 1] <= s) {
      ++below;
    }
    const double part = (s - (*lengths)[below]) / ((*lengths)[below + 1] - (*lengths)[below]);
    auto point = curve.at(kTurn * (static_cast<double>(below) + part) / kFine);
    if (!point) {
      return std::nullopt;
    }
    point->s_mm = s;
    out.points.push_back(*point);
  }
  return out;
}

struct OpenSides {
  Vector3d n_shell;
  Vector3d n_nozzle;
  Vector3d shell_edge;   ///< At x = 0.
  Vector3d nozzle_edge;  ///< At x = 0.
};

OpenSides open_sides(const JointConfig& joint) {
  if (joint.kind == JointKind::kTFillet) {
    return {Vector3d::UnitZ(), Vector3d::UnitY(), Vector3d::Zero(), {0.0, 0.0, joint.gap_mm}};
  }
  const Vector3d half_gap(0.0, 0.5 * joint.gap_mm, 0.0);
  return {Vector3d::UnitZ(), Vector3d::UnitZ(), half_gap, -half_gap};
}

TruthCurve sample_open(const JointConfig& joint, ReferenceCurve reference) {
  const OpenSides sides = open_sides(joint);
  Vector3d middle = sides.shell_edge;
  if (reference == ReferenceCurve::kNozzleEdge) {
    middle = sides.nozzle_edge;
  } else if (reference == ReferenceCurve::kGapMiddle ||
             (reference == ReferenceCurve::kRoot && joint.kind == JointKind::kButt)) {
    middle = 0.5 * (sides.shell_edge + sides.nozzle_edge);
  }
  TruthCurve out;
  out.closed = false;
  out.length_mm = joint.shell_length_mm;
  const int steps = static_cast<int>(std::ceil(out.length_mm / kStepMm));
  for (int i = 0; i <= steps; ++i) {
    TruthPoint point;
    point.s_mm = out.length_mm * i / steps;
    point.p = middle + Vector3d(point.s_mm - 0.5 * out.length_mm, 0.0, 0.0);
    set_normals(point, sides.n_shell, sides.n_nozzle);
    out.points.push_back(point);
  }
  return out;
}

bool has_curve(const JointConfig& joint, ReferenceCurve reference) {
  const bool edge_of_nozzle = reference == ReferenceCurve::kNozzleEdge;
  const bool free_end = joint.kind != JointKind::kSetIn && joint.gap_mm > 0.0;
  return joint.kind != JointKind::kShellOnly && (!edge_of_nozzle || free_end);
}

}  // namespace

std::optional<TruthCurve> truth_curve(const JointConfig& joint, ReferenceCurve reference) {
  if (!has_curve(joint, reference)) {
    return std::nullopt;
  }
  if (!is_closed(joint.kind)) {
    return sample_open(joint, reference);
  }
  // A nozzle set on has no hole beside it: its joint's middle is between root and nozzle's edge,
  // one above the other.
  if (joint.kind == JointKind::kSetOn && reference == ReferenceCurve::kGapMiddle) {
    JointConfig half = joint;
    half.gap_mm = 0.5 * joint.gap_mm;
    return sample_closed(half,
                         joint.gap_mm > 0.0 ? ReferenceCurve::kNozzleEdge : ReferenceCurve::kRoot);
  }
  return sample_closed(joint, reference);
}

TruthCurve transformed(const geometry::RigidTransform& T_to_from, TruthCurve curve) {
  for (TruthPoint& point : curve.points) {
    point.p = T_to_from * point.p;
    point.tangent = T_to_from.rotation * point.tangent;
    point.n_shell = T_to_from.rotation * point.n_shell;
    point.n_nozzle = T_to_from.rotation * point.n_nozzle;
  }
  return curve;
}

}  // namespace dseam::hal::sim
