// SPDX-License-Identifier: Apache-2.0
#include "torch_curve.hpp"

#include <algorithm>
#include <cmath>

namespace dseam::torch {

double TorchCurve::spacing_mm() const noexcept {
  return view_.length_mm / static_cast<double>(num_segments());
}

TorchPoint TorchCurve::at(double s_mm) const noexcept {
  const double length = view_.length_mm;
  const double wrapped = view_.closed ? s_mm - length * std::floor(s_mm / length) : s_mm;
  const double h = spacing_mm();
  const double place = std::clamp(wrapped / h, 0.0, static_cast<double>(num_segments()));
  const auto i = std::min(static_cast<std::size_t>(place), num_segments() - 1);
  const double u = place - static_cast<double>(i);
  const double v = 1.0 - u;
  const TorchPoint& a = view_.points[i];
  const TorchPoint& b = view_.points[(i + 1) % view_.points.size()];
  TorchPoint point = u < 0.5 ? a : b;
  point.s_mm = s_mm;
  point.pose.p_base = v * v * (1.0 + 2.0 * u) * a.pose.p_base + u * v * v * h * a.tangent +
                      u * u * (1.0 + 2.0 * v) * b.pose.p_base - u * u * v * h * b.tangent;
  point.pose.q_base_torch = a.pose.q_base_torch.slerp(u, b.pose.q_base_torch);
  point.tangent = (v * a.tangent + u * b.tangent).normalized();
  point.out = (v * a.out + u * b.out).normalized();
  point.across = (v * a.across + u * b.across).normalized();
  point.confidence = u > 1e-9 ? std::min(a.confidence, b.confidence) : a.confidence;
  if (u > 1e-9 && (a.weldable != Weldable::kYes || b.weldable != Weldable::kYes)) {
    point.weldable = a.weldable != Weldable::kYes ? a.weldable : b.weldable;
  }
  return point;
}

double turn_about_wire(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) noexcept {
  const Eigen::Quaterniond d = a.conjugate() * b;
  return d.w() < 0.0 ? 2.0 * std::atan2(-d.z(), -d.w()) : 2.0 * std::atan2(d.z(), d.w());
}

double TorchCurve::wrist_turn(double from_mm, double to_mm) const noexcept {
  const double steps = std::max(1.0, std::ceil(std::abs(to_mm - from_mm) / spacing_mm()));
  double turn = 0.0;
  Eigen::Quaterniond before = at(from_mm).pose.q_base_torch;
  for (double k = 1.0; k <= steps; k += 1.0) {
    const Eigen::Quaterniond q = at(from_mm + (to_mm - from_mm) * k / steps).pose.q_base_torch;
    turn += turn_about_wire(before, q);
    before = q;
  }
  return turn;
}

}  // namespace dseam::torch
