// SPDX-License-Identifier: Apache-2.0
#include "path_writer.hpp"

#include <algorithm>
#include <cmath>

namespace dseam::torch {
namespace {

constexpr double kSamePlaceMm = 1e-6;
constexpr double kFewestSteps = 4.0;

void apply(const Stroke& stroke, PathPoint& point) noexcept {
  point.speed_mm_s = stroke.speed_mm_s;
  point.segment = stroke.segment;
  point.arc = stroke.arc;
  point.gas = stroke.gas;
  point.wire = stroke.wire;
  point.pass = stroke.pass;
  point.schedule = stroke.schedule;
  point.confidence = stroke.confidence;
}

}  // namespace

void PathWriter::append(const TorchPose& pose, const Stroke& stroke) noexcept {
  PathPoint point;
  point.pose = pose;
  point.s_mm = s_mm_;
  apply(stroke, point);
  full_ = !out_.append(point) || full_;
}

void PathWriter::move_to(const TorchPose& pose, double step_mm, const Stroke& stroke) noexcept {
  if (empty()) {
    append(pose, stroke);
    return;
  }
  s_mm_ += step_mm;
  append(pose, stroke);
}

void PathWriter::set_stroke(const Stroke& stroke) noexcept {
  if (empty()) {
    return;
  }
  if (out_[out_.size() - 1].dwell_s > 0.0) {  // Its own stroke holds while it stands.
    append(TorchPose(last()), stroke);
  } else {
    apply(stroke, out_[out_.size() - 1]);
  }
}

void PathWriter::stop() noexcept {
  if (!empty()) {
    out_[out_.size() - 1].stop = true;
  }
}

void PathWriter::stand(double dwell_s, const Stroke& stroke) noexcept {
  if (empty() || !(dwell_s > 0.0)) {
    return;
  }
  set_stroke(stroke);
  stop();
  out_[out_.size() - 1].dwell_s = dwell_s;
}

void PathWriter::line_to(const TorchPose& pose, double step_mm, const Stroke& stroke) noexcept {
  if (empty()) {
    append(pose, stroke);
    return;
  }
  const TorchPose from = last();
  const double length_mm = (pose.p_base - from.p_base).norm();
  if (!(length_mm > kSamePlaceMm)) {
    return;
  }
  set_stroke(stroke);
  const double steps = std::max(kFewestSteps, std::ceil(length_mm / step_mm));
  for (double k = 1.0; k <= steps; k += 1.0) {
    const double u = k / steps;
    move_to({from.p_base + u * (pose.p_base - from.p_base),
             from.q_base_torch.slerp(u, pose.q_base_torch)},
            length_mm / steps, stroke);
  }
  stop();
}

}  // namespace dseam::torch
