// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/pipes/pipe_match.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <utility>

#include "dseam/geometry/symmetric_matrix.hpp"

namespace dseam::splice {
namespace {

using geometry::Cylinder;
using geometry::Matrix6;
using geometry::RigidTransform;
using geometry::Vector6;

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;
using Rows5 = Eigen::Matrix<double, 5, 6>;
using Vector10 = Eigen::Matrix<double, 10, 1>;
using Matrix10 = Eigen::Matrix<double, 10, 10>;
using Rows10 = Eigen::Matrix<double, 10, 6>;
using Depths10 = Eigen::Matrix<double, 10, 3>;

// What real pipes differ from a cylinder by, from one view of them to the next; for the test alone.
constexpr double kFormMm = 0.1;
constexpr double kFormRad = 1e-3;

// Shell and what is seen of the nozzle.
struct Axes {
  const Pipe& shell;
  const Pipe& nozzle;
};

// x along the shell's axis in the sense given, z near the nozzle's, in the foot of the axes' common
// perpendicular on the nozzle's.
RigidTransform frame_of(const Axes& pair, double sense) noexcept {
  const Cylinder& shell = pair.shell.fit.cylinder;
  const Cylinder& nozzle = pair.nozzle.fit.cylinder;
  RigidTransform frame;
  const Eigen::Vector3d x = sense * shell.axis;
  const Eigen::Vector3d y = nozzle.axis.cross(x).normalized();
  frame.rotation << x, y, x.cross(y);
  const Eigen::Vector3d across = y.cross(x);
  const Eigen::Vector3d between = shell.point_mm - nozzle.point_mm;
  frame.translation_mm =
      nozzle.point_mm + nozzle.axis * (across.dot(between) / across.dot(nozzle.axis));
  return frame;
}

// One pipe of b beside that of a, in a's parameters.
struct Comparison {
  Vector5 residual;
  Rows5 jacobian = Rows5::Zero();  // Of a left perturbation about a's origin.
  Matrix5 to_a = Matrix5::Zero();  // From b's parameters to a's.
};

Comparison compare(const Pipe& a, const Pipe& b, const RigidTransform& T_a_b,
                   const Eigen::Vector3d& axis_a) noexcept {
  const Eigen::Vector3d& e1 = a.fit.e1;
  const Eigen::Vector3d& e2 = a.fit.e2;
  Eigen::Vector3d d = T_a_b.rotation * b.fit.cylinder.axis;
  const double sense = d.dot(axis_a) < 0.0 ? -1.0 : 1.0;
  d *= sense;
  const Eigen::Vector3d p_b = T_a_b * b.fit.cylinder.point_mm;
  const double along = axis_a.dot(a.fit.cylinder.point_mm - p_b) / axis_a.dot(d);
  const Eigen::Vector3d p = p_b + along * d;
  const Eigen::Vector3d shift = p - a.fit.cylinder.point_mm;
  Comparison out;
  out.residual << e1.dot(shift), e2.dot(shift), e1.dot(d), e2.dot(d),
      b.fit.cylinder.radius_mm - a.fit.cylinder.radius_mm;
  int row = 0;
  for (const Eigen::Vector3d* e : {&e1, &e2}) {
    out.jacobian.row(row) << e->transpose(), p.cross(*e).transpose();
    out.jacobian.row(row + 2).tail<3>() = d.cross(*e).transpose();
    const Eigen::RowVector2d turn(e->dot(T_a_b.rotation * b.fit.e1),
                                  e->dot(T_a_b.rotation * b.fit.e2));
    out.to_a.row(row).head<2>() = turn;
    out.to_a.row(row).segment<2>(2) = along * sense * turn;
    out.to_a.row(row + 2).segment<2>(2) = sense * turn;
    ++row;
  }
  out.to_a(4, 4) = 1.0;
  return out;
}

struct System {
  Vector10 residual;
  Rows10 jacobian;
  Matrix10 covariance = Matrix10::Zero();
};

[[gnu::noinline]] System compare(const Axes& a, const Axes& b, const RigidTransform& T_a_b,
                                 double depth_sigma_mm) noexcept {
  System out;
  Depths10 depths;
  int at = 0;
  for (const auto& [of_a, of_b] :
       {std::pair(&a.shell, &b.shell), std::pair(&a.nozzle, &b.nozzle)}) {
    const Comparison c = compare(*of_a, *of_b, T_a_b, of_a->fit.cylinder.axis);
    out.residual.segment<5>(at) = c.residual;
    out.jacobian.middleRows<5>(at) = c.jacobian;
    out.covariance.block<5, 5>(at, at) =
        of_a->fit.covariance + c.to_a * of_b->fit.covariance * c.to_a.transpose();
    depths.middleRows<5>(at) = c.to_a * of_b->depth_effect - of_a->depth_effect;
    at += 5;
  }
  depths *= depth_sigma_mm;
  // Lazy products: Eigen's general one of this size holds a branch that asks for a heap.
  out.covariance += depths.lazyProduct(depths.transpose());
  return out;
}

Vector10 form_variance() noexcept {
  Vector5 of_one;
  of_one << kFormMm, kFormMm, kFormRad, kFormRad, kFormMm;
  Vector10 out;
  out << of_one, of_one;
  return out.cwiseAbs2();
}

// Each apart from the others, so that the stack holds one factor at a time.
[[gnu::noinline]] Rows10 weighted(const System& s) noexcept {
  const Eigen::LLT<Matrix10> factor(s.covariance);
  Rows10 out;
  for (int column = 0; column < out.cols(); ++column) {
    out.col(column) = factor.solve(Vector10(s.jacobian.col(column)));
  }
  return out;
}

// One step of Gauss-Newton.
[[gnu::noinline]] void step(const Axes& a, const Axes& b, double depth_sigma_mm,
                            PipePlace& place) noexcept {
  const System s = compare(a, b, place.T_a_b, depth_sigma_mm);
  const Rows10 rows = weighted(s);
  place.covariance =
      geometry::inverse_of_symmetric<6>(Matrix6(s.jacobian.transpose().lazyProduct(rows)));
  const Vector6 gradient = rows.transpose() * s.residual;
  place.T_a_b = geometry::perturbed(place.T_a_b, -(place.covariance * gradient));
}

[[gnu::noinline]] double chi_squared(const Axes& a, const Axes& b, double depth_sigma_mm,
                                     const RigidTransform& T_a_b) noexcept {
  System s = compare(a, b, T_a_b, depth_sigma_mm);
  s.covariance.diagonal() += form_variance();
  const Eigen::LLT<Matrix10> factor(s.covariance);
  return s.residual.dot(factor.solve(s.residual));
}

PipePlace settle(const Axes& a, const Axes& b, const RigidTransform& start,
                 double depth_sigma_mm) noexcept {
  constexpr int kIterations = 6;
  PipePlace place;
  place.T_a_b = start;
  for (int i = 0; i < kIterations; ++i) {
    step(a, b, depth_sigma_mm, place);
  }
  place.chi_squared = chi_squared(a, b, depth_sigma_mm, place.T_a_b);
  return place;
}

}  // namespace

PipePlaces match_pipes(const PipePair& a, const PipePair& b, double depth_sigma_mm) noexcept {
  PipePlaces out;
  const bool by_outside = a.nozzle.usable && b.nozzle.usable;
  if (!by_outside && !(a.bore.usable && b.bore.usable)) {
    return out;
  }
  const Axes of_a{a.shell, by_outside ? a.nozzle : a.bore};
  const Axes of_b{b.shell, by_outside ? b.nozzle : b.bore};
  const RigidTransform T_a_frame = frame_of(of_a, 1.0);
  out.places[0] = settle(of_a, of_b, T_a_frame * frame_of(of_b, 1.0).inverse(), depth_sigma_mm);
  out.places[1] = settle(of_a, of_b, T_a_frame * frame_of(of_b, -1.0).inverse(), depth_sigma_mm);
  return out;
}

}  // namespace dseam::splice
