// SPDX-License-Identifier: Apache-2.0
#include "dseam/trajectory/path_spline.hpp"

#include <algorithm>
#include <cmath>

namespace dseam::trajectory {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// The rotation vector that takes `a` to `b`, in the frame of `a`; the short way round.
Vector3d turn_between(const Quaterniond& a, const Quaterniond& b) noexcept {
  Quaterniond d = a.conjugate() * b;
  if (d.w() < 0.0) {
    d.coeffs() = -d.coeffs();
  }
  const double sine = d.vec().norm();
  if (sine < 1e-12) {
    return 2.0 * d.vec();
  }
  return (2.0 * std::atan2(sine, d.w()) / sine) * d.vec();
}

Quaterniond rotated_by(const Vector3d& turn) noexcept {
  const double angle = turn.norm();
  if (angle < 1e-12) {
    return Quaterniond(1.0, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z());
  }
  const Vector3d axis = std::sin(0.5 * angle) / angle * turn;
  return Quaterniond(std::cos(0.5 * angle), axis.x(), axis.y(), axis.z());
}

/// The four basis functions of a uniform cubic B-spline, or one of their derivatives by u.
std::array<double, 4> basis(double u, int derivative) noexcept {
  const double v = 1.0 - u;
  switch (derivative) {
    case 0:
      return {v * v * v / 6.0, (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
              (3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0, u * u * u / 6.0};
    case 1:
      return {-0.5 * v * v, 0.5 * (3.0 * u * u - 4.0 * u), 0.5 * (4.0 * v - 3.0 * v * v),
              0.5 * u * u};
    case 2:
      return {v, 3.0 * u - 2.0, 3.0 * v - 2.0, u};
    default:
      return {-1.0, 3.0, -3.0, 1.0};
  }
}

template <typename T>
T blend(const std::array<T, 4>& c, double u, int derivative) noexcept {
  const std::array<double, 4> b = basis(u, derivative);
  return b[0] * c[0] + b[1] * c[1] + b[2] * c[2] + b[3] * c[3];
}

/// Cumulative basis of the three turns, or a derivative of it by u.
std::array<double, 3> cumulative(double u, int derivative) noexcept {
  const std::array<double, 4> b = basis(u, derivative);
  return {b[1] + b[2] + b[3], b[2] + b[3], b[3]};
}

}  // namespace

PathSpan::PathSpan(torch::PathView path, std::size_t begin, std::size_t end,
                   std::size_t i) noexcept {
  const torch::PathPoint& a = path[i];
  const torch::PathPoint& b = path[i + 1];
  p_[1] = a.pose.p_base;
  p_[2] = b.pose.p_base;
  s_[1] = a.s_mm;
  s_[2] = b.s_mm;
  turn_[1] = turn_between(a.pose.q_base_torch, b.pose.q_base_torch);
  // Past an end the stretch goes on straight, so that the curve passes through the end point.
  const bool first = i == begin;
  p_[0] = first ? Vector3d(2.0 * p_[1] - p_[2]) : path[i - 1].pose.p_base;
  s_[0] = first ? 2.0 * s_[1] - s_[2] : path[i - 1].s_mm;
  turn_[0] = first ? turn_[1] : turn_between(path[i - 1].pose.q_base_torch, a.pose.q_base_torch);
  const bool last = i + 1 == end;
  p_[3] = last ? Vector3d(2.0 * p_[2] - p_[1]) : path[i + 2].pose.p_base;
  s_[3] = last ? 2.0 * s_[2] - s_[1] : path[i + 2].s_mm;
  turn_[2] = last ? turn_[1] : turn_between(b.pose.q_base_torch, path[i + 2].pose.q_base_torch);
  q_first_ = a.pose.q_base_torch * rotated_by(-turn_[0]);
}

double PathSpan::s_at(double u) const noexcept { return blend(s_, u, 0); }

double PathSpan::parameter_at(double s_mm) const noexcept {
  const double s0 = s_at(0.0);
  double u = std::clamp((s_mm - s0) / (s_at(1.0) - s0), 0.0, 1.0);
  for (int i = 0; i < 6; ++i) {
    const double step = (s_at(u) - s_mm) / blend(s_, u, 1);
    u = std::clamp(u - step, 0.0, 1.0);
    if (std::abs(step) < 1e-13) {
      break;
    }
  }
  return u;
}

torch::TorchPose PathSpan::pose_at(double u) const noexcept {
  const std::array<double, 3> c = cumulative(u, 0);
  torch::TorchPose pose;
  pose.p_base = blend(p_, u, 0);
  pose.q_base_torch = (q_first_ * rotated_by(c[0] * turn_[0]) * rotated_by(c[1] * turn_[1]) *
                       rotated_by(c[2] * turn_[2]))
                          .normalized();
  return pose;
}

PathRates PathSpan::rates_at(double u) const noexcept {
  const double su = blend(s_, u, 1);
  const double suu = blend(s_, u, 2);
  const double suuu = blend(s_, u, 3);
  const Vector3d ps = blend(p_, u, 1) / su;
  const Vector3d pss = (blend(p_, u, 2) - ps * suu) / (su * su);
  const Vector3d psss = (blend(p_, u, 3) - 3.0 * su * suu * pss - suuu * ps) / (su * su * su);

  const std::array<double, 3> c0 = cumulative(u, 0);
  const std::array<double, 3> c1 = cumulative(u, 1);
  const std::array<double, 3> c2 = cumulative(u, 2);
  Vector3d w = Vector3d::Zero();
  Vector3d dw = Vector3d::Zero();
  for (std::size_t j = 0; j < 3; ++j) {
    const Quaterniond back = rotated_by(c0[j] * turn_[j]).conjugate();
    w = back * w + c1[j] * turn_[j];
    dw = back * dw + c1[j] * w.cross(turn_[j]) + c2[j] * turn_[j];
  }
  const Vector3d ws = w / su;
  const Vector3d wss = (dw - ws * suu) / (su * su);
  return {ps.norm(), pss.norm(), psss.norm(), ws.norm(), wss.norm()};
}

}  // namespace dseam::trajectory
