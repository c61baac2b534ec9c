// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dseam/trajectory/path_spline.hpp"
#include "dseam/trajectory/time_scaling.hpp"

namespace dseam::test {

/// The torch's motion at one moment, by the chain rule from the time law and the spline.
struct ExactMotion {
  Eigen::Vector3d velocity, acceleration, jerk;
  Eigen::Quaterniond q;
};

/// A timed path's own derivatives, worked out anew from its nodes and points: what a sampler can
/// only show the mean of.
class ExactLaw {
 public:
  explicit ExactLaw(const trajectory::TimedPathView& timed) : timed_(timed) {
    for (std::size_t begin = 0; begin + 1 < timed.path.size();) {
      const std::size_t end = end_of_stretch(begin);
      for (std::size_t i = begin; i < end; ++i) {
        stretch_of_.push_back({begin, end});
        knot_mm_.push_back(blend(controls_mm(begin, end, i), 0.0, 0));
      }
      begin = end;
    }
    for (const trajectory::TimeNode& node : timed.nodes) {
      breaks_s_.push_back(node.t_s);
      breaks_s_.push_back(node.t_s + timed.window_s);
    }
    std::sort(breaks_s_.begin(), breaks_s_.end());
  }

  /// Where jerk may jump; between two of them the time law is smooth.
  [[nodiscard]] const std::vector<double>& breaks_s() const { return breaks_s_; }

  /// `t_s` must not lie on a break.
  [[nodiscard]] ExactMotion at(double t_s) const {
    const Moment now = moment(t_s);
    const Moment then = moment(t_s - timed_.window_s);
    const double w = timed_.window_s;
    const std::array<double, 4> s = {(now.integral - then.integral) / w + timed_.path[0].s_mm,
                                     (now.s - then.s) / w, (now.v - then.v) / w,
                                     (now.a - then.a) / w};
    return move(now.point, s);
  }

 private:
  struct Stretch {
    std::size_t begin, end;
  };
  struct Moment {
    double integral = 0.0, s = 0.0, v = 0.0, a = 0.0;
    std::size_t point = 0;
  };

  [[nodiscard]] std::size_t end_of_stretch(std::size_t begin) const {
    const auto apart = [&](std::size_t i) {
      return timed_.path[i + 1].s_mm - timed_.path[i].s_mm > 1e-9;
    };
    std::size_t end = begin + 1;
    while (apart(begin) && end + 1 < timed_.path.size() && !timed_.path[end].stop && apart(end)) {
      ++end;
    }
    return end;
  }

  [[nodiscard]] Moment moment(double t_s) const {
    if (t_s <= 0.0) {
      return {};
    }
    const auto after =
        std::upper_bound(timed_.nodes.begin(), timed_.nodes.end(), t_s,
                         [](double t, const trajectory::TimeNode& node) { return t < node.t_s; });
    const trajectory::TimeNode& a = *(after - 1);
    const double dt = t_s - a.t_s;
    const bool ends = after == timed_.nodes.end() || a.rests || after->t_s <= a.t_s;
    const double acc = ends ? 0.0 : (after->v_mm_s - a.v_mm_s) / (after->t_s - a.t_s);
    return {a.integral_mm_s + dt * a.s_mm + dt * dt * a.v_mm_s / 2.0 + dt * dt * dt * acc / 6.0,
            a.s_mm + dt * a.v_mm_s + dt * dt * acc / 2.0, a.v_mm_s + dt * acc, acc, a.point};
  }

  /// The control values of the span from point `i` on; straight on beyond the stretch.
  template <typename T, typename Of>
  [[nodiscard]] static std::array<T, 4> controls(std::size_t begin, std::size_t end, std::size_t i,
                                                 const Of& of) {
    const T b = of(i);
    const T c = of(i + 1);
    return {i == begin ? T(2.0 * b - c) : of(i - 1), b, c,
            i + 1 == end ? T(2.0 * c - b) : of(i + 2)};
  }
  [[nodiscard]] std::array<double, 4> controls_mm(std::size_t begin, std::size_t end,
                                                  std::size_t i) const {
    return controls<double>(begin, end, i, [&](std::size_t k) { return timed_.path[k].s_mm; });
  }

  /// The uniform cubic B-spline through its matrix, and its derivatives.
  template <typename T>
  [[nodiscard]] static T blend(const std::array<T, 4>& c, double u, int derivative) {
    const T c0 = (c[0] + 4.0 * c[1] + c[2]) / 6.0;
    const T c1 = (c[2] - c[0]) / 2.0;
    const T c2 = (c[0] - 2.0 * c[1] + c[2]) / 2.0;
    const T c3 = (c[3] - 3.0 * c[2] + 3.0 * c[1] - c[0]) / 6.0;
    switch (derivative) {
      case 0:
        return c0 + u * (c1 + u * (c2 + u * c3));
      case 1:
        return c1 + u * (2.0 * c2 + u * 3.0 * c3);
      case 2:
        return 2.0 * c2 + u * 6.0 * c3;
      default:
        return 6.0 * c3;
    }
  }

  [[nodiscard]] ExactMotion move(std::size_t front, const std::array<double, 4>& s) const {
    const Stretch stretch = stretch_of_[std::min(front, stretch_of_.size() - 1)];
    const auto first = knot_mm_.begin() + static_cast<std::ptrdiff_t>(stretch.begin);
    const auto last = knot_mm_.begin() + static_cast<std::ptrdiff_t>(stretch.end);
    const auto after = std::upper_bound(first, last, s[0]);
    const std::size_t i =
        after == first ? stretch.begin : static_cast<std::size_t>(after - knot_mm_.begin()) - 1;
    const auto sc = controls_mm(stretch.begin, stretch.end, i);
    const auto pc = controls<Eigen::Vector3d>(
        stretch.begin, stretch.end, i,
        [&](std::size_t k) -> Eigen::Vector3d { return timed_.path[k].pose.p_base; });
    double low = 0.0;
    double high = 1.0;
    for (int n = 0; n < 40; ++n) {
      const double middle = 0.5 * (low + high);
      (blend(sc, middle, 0) < s[0] ? low : high) = middle;
    }
    const double u = 0.5 * (low + high);
    const double a = blend(sc, u, 1);
    const double b = blend(sc, u, 2);
    const double u1 = s[1] / a;
    const double u2 = (s[2] - b * u1 * u1) / a;
    const double u3 = (s[3] - 3.0 * b * u1 * u2 - blend(sc, u, 3) * u1 * u1 * u1) / a;
    const Eigen::Vector3d p1 = blend(pc, u, 1);
    const Eigen::Vector3d p2 = blend(pc, u, 2);
    const trajectory::PathSpan span(timed_.path, stretch.begin, stretch.end, i);
    return {p1 * u1, p2 * (u1 * u1) + p1 * u2,
            blend(pc, u, 3) * (u1 * u1 * u1) + 3.0 * u1 * u2 * p2 + p1 * u3,
            span.pose_at(u).q_base_torch};
  }

  trajectory::TimedPathView timed_;
  std::vector<Stretch> stretch_of_;
  std::vector<double> knot_mm_;
  std::vector<double> breaks_s_;
};

}  // namespace dseam::test
