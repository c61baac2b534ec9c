// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/replay/replay_camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace dseam::hal::replay {
namespace {

/// Poses that are nearer in time than this cannot be told apart.
constexpr std::int64_t kShortestPeriodNs = 1'000'000;

bool same_camera(const ScanView& a, const ScanView& b) {
  const depth::Intrinsics& k = a.camera.intrinsics;
  const depth::Intrinsics& l = b.camera.intrinsics;
  return k.width == l.width && k.height == l.height && k.fx == l.fx && k.fy == l.fy &&
         k.cx == l.cx && k.cy == l.cy && a.camera.mm_per_count == b.camera.mm_per_count &&
         a.gray.empty() == b.gray.empty();
}

bool has_stamps(const ScanSet& set) {
  return std::ranges::all_of(set.views, [](const ScanView& v) { return bool(v.camera.stamp_ns); });
}

std::string view_text(const ScanView& view) { return "view " + std::to_string(view.camera.id); }

/// Empty when the set can be played.
std::string fault_in(const ScanSet& set) {
  if (set.views.empty()) {
    return "the scan set has no view";
  }
  const bool stamped = has_stamps(set);
  for (std::size_t i = 1; i < set.views.size(); ++i) {
    if (!same_camera(set.views[i], set.views[0])) {
      return view_text(set.views[i]) + ": its camera differs from the first view's";
    }
    if (stamped &&
        *set.views[i].camera.stamp_ns - *set.views[i - 1].camera.stamp_ns < kShortestPeriodNs) {
      return view_text(set.views[i]) + ": its stamp is not a millisecond after the one before";
    }
  }
  return {};
}

std::string fault_in(const ReplayCamera::Options& options) {
  constexpr double kFastest = 1000.0;
  if (!(options.speed >= 1.0 / kFastest && options.speed <= kFastest)) {
    return "replay speed: 0.001 to 1000";
  }
  if (options.num_buffers == 0 || options.num_buffers > SlotPool::kMaxSlots) {
    return "replay buffers: 1 to 32";
  }
  return options.period_ns < kShortestPeriodNs ? "replay period: at least 1 ms" : "";
}

depth::DepthModel model_of(const ScanView& view) {
  depth::DepthModel model;
  model.intrinsics = view.camera.intrinsics;
  model.scale.back() = view.camera.mm_per_count;
  model.has_gray = !view.gray.empty();
  return model;
}

std::size_t frame_bytes(const ScanView& view) {
  return view.depth.size() * sizeof(std::uint16_t) + view.gray.size();
}

}  // namespace

Loaded<std::unique_ptr<ReplayCamera>> ReplayCamera::make(ScanSet set, const Options& options,
                                                         Clock& clock) {
  for (std::string fault : {fault_in(set), fault_in(options)}) {
    if (!fault.empty()) {
      return LoadFault{std::move(fault)};
    }
  }
  return std::unique_ptr<ReplayCamera>(new ReplayCamera(std::move(set), options, clock));
}

ReplayCamera::ReplayCamera(ScanSet set, const Options& options, Clock& clock)
    : set_(std::move(set)),
      options_(options),
      clock_(clock),
      model_(model_of(set_.views.front())),
      buffers_(options.num_buffers, Bytes(frame_bytes(set_.views.front()))),
      slots_(options.num_buffers) {
  const bool stamped = has_stamps(set_);
  for (const ScanView& view : set_.views) {
    const auto evenly = static_cast<std::int64_t>(stamps_ns_.size()) * options.period_ns;
    stamps_ns_.push_back(stamped ? *view.camera.stamp_ns - *set_.views.front().camera.stamp_ns
                                 : evenly);
  }
  const auto pauses = static_cast<std::int64_t>(std::max<std::size_t>(stamps_ns_.size() - 1, 1));
  const std::int64_t length_ns = stamps_ns_.back();
  duration_ns_ = length_ns + (length_ns > 0 ? length_ns / pauses : options.period_ns);
}

Result<> ReplayCamera::do_start(FrameMode mode) noexcept {
  if (running_.exchange(true)) {
    return Errc::kUnavailable;
  }
  mode_ = mode;
  first_frame_ = next_frame_;
  started_ns_ = clock_.now_ns();
  return {};
}

std::int64_t ReplayCamera::recorded_ns(std::uint64_t frame) const noexcept {
  const auto passes = static_cast<std::int64_t>(frame / stamps_ns_.size());
  return passes * duration_ns_ + stamps_ns_[frame % stamps_ns_.size()];
}

std::int64_t ReplayCamera::due_ns(std::uint64_t frame) const noexcept {
  if (options_.step) {
    return captured_ns_ + kShortestPeriodNs;
  }
  const auto from_start = static_cast<double>(recorded_ns(frame) - recorded_ns(first_frame_));
  return started_ns_ + kShortestPeriodNs + std::llround(from_start / options_.speed);
}

void ReplayCamera::skip_overtaken() noexcept {
  const std::int64_t now_ns = clock_.now_ns();
  while (mode_ == FrameMode::kLatest && !options_.step && !at_end(next_frame_ + 1) &&
         due_ns(next_frame_ + 1) <= now_ns) {
    ++next_frame_;
    ++counters_.skipped;
  }
}

Result<FrameLease> ReplayCamera::do_next(std::chrono::nanoseconds timeout) noexcept {
  if (!running_) {
    return Errc::kUnavailable;
  }
  if (at_end(next_frame_)) {
    return Errc::kNotFound;
  }
  const std::int64_t deadline_ns = clock_.now_ns() + timeout.count();
  skip_overtaken();
  const std::int64_t due = due_ns(next_frame_);
  if (clock_.now_ns() < due) {
    clock_.sleep_until(std::min(due, deadline_ns));
  }
  if (!running_) {
    return Errc::kUnavailable;
  }
  if (clock_.now_ns() < due) {
    return Errc::kTimeout;
  }
  const std::uint32_t slot = slots_.take();
  if (slot == SlotPool::kNone) {  // The recording waits: the frame is not lost.
    ++counters_.underruns;
    clock_.sleep_until(deadline_ns);
    return Errc::kTimeout;
  }
  return expose(slot);
}

FrameLease ReplayCamera::expose(std::uint32_t slot) noexcept {
  const ScanView& view = set_.views[next_frame_ % set_.views.size()];
  Bytes& buffer = buffers_[slot];
  const std::size_t depth_bytes = view.depth.size() * sizeof(std::uint16_t);
  std::memcpy(buffer.data(), view.depth.data(), depth_bytes);
  std::ranges::copy(std::as_bytes(std::span(view.gray)),
                    buffer.begin() + static_cast<std::ptrdiff_t>(depth_bytes));
  captured_ns_ = options_.step ? clock_.now_ns() : due_ns(next_frame_);
  report_pose(view.camera, captured_ns_);
  DepthFrame frame;
  frame.depth = std::span(buffer).first(depth_bytes);
  frame.gray = std::span(buffer).subspan(depth_bytes);
  frame.sequence = next_frame_;
  frame.device_ns = set_.views.front().camera.stamp_ns.value_or(0) + recorded_ns(next_frame_);
  frame.captured_ns = captured_ns_;
  frame.dequeued_ns = clock_.now_ns();
  ++next_frame_;
  ++counters_.delivered;
  return {*this, frame, slot};
}

void ReplayCamera::report_pose(const ViewCamera& camera, std::int64_t captured_ns) noexcept {
  const bool flange = camera.T_base_flange && (options_.flange_poses || !camera.T_base_camera);
  if (!flange && !camera.T_base_camera) {
    return;
  }
  StampedPose pose;
  pose.stamp_ns = captured_ns;
  pose.of = flange ? PoseOf::kFlange : PoseOf::kCamera;
  pose.T_base_reported = flange ? *camera.T_base_flange : *camera.T_base_camera;
  (void)robot_.stand(pose, kShortestPeriodNs / 4);  // Frames are at least a period apart.
}

}  // namespace dseam::hal::replay
