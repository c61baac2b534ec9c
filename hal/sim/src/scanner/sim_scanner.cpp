// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/sim_scanner.hpp"

#include <algorithm>
#include <cstring>
#include <thread>

namespace dseam::hal::sim {
namespace {

depth::DepthModel model_of(const ScannerConfig& scanner) {
  depth::DepthModel model;
  model.intrinsics = intrinsics(scanner);
  model.scale.back() = scanner.mm_per_count;
  model.has_gray = true;
  return model;
}

std::size_t frame_bytes(const ScannerConfig& scanner) {
  return std::size_t{scanner.width} * scanner.height *
         (sizeof(std::uint16_t) + sizeof(std::uint8_t));
}

void render_share(const Cell& cell, std::size_t first, std::size_t step,
                  std::vector<std::vector<std::byte>>& frames) {
  Rendering rendering;
  for (std::size_t i = first; i < frames.size(); i += step) {
    cell.scan(i, rendering);
    const std::size_t depth_bytes = rendering.depth.size() * sizeof(std::uint16_t);
    std::memcpy(frames[i].data(), rendering.depth.data(), depth_bytes);
    std::memcpy(frames[i].data() + depth_bytes, rendering.gray.data(), rendering.gray.size());
  }
}

void render_all(const Cell& cell, std::vector<std::vector<std::byte>>& frames) {
  const std::size_t cores = std::clamp(std::thread::hardware_concurrency(), 1U, 8U);
  std::vector<std::jthread> workers;
  for (std::size_t i = 0; i < cores; ++i) {
    workers.emplace_back([&cell, &frames, i, cores] { render_share(cell, i, cores, frames); });
  }
}

}  // namespace

Result<std::unique_ptr<SimScanner>> SimScanner::make(const Cell& cell, const Options& options,
                                                     Clock& clock) {
  if (options.num_buffers == 0 || options.num_buffers > SlotPool::kMaxSlots ||
      options.period_ns <= 0) {
    return Errc::kInvalidArgument;
  }
  return std::unique_ptr<SimScanner>(new SimScanner(cell, options, clock));
}

SimScanner::SimScanner(const Cell& cell, const Options& options, Clock& clock)
    : options_(options),
      clock_(clock),
      model_(model_of(cell.config().scanner)),
      views_(cell.views()),
      frames_(views_.size(), Bytes(frame_bytes(cell.config().scanner))),
      buffers_(options.num_buffers, Bytes(frame_bytes(cell.config().scanner))),
      slots_(options.num_buffers) {
  render_all(cell, frames_);
}

Result<> SimScanner::do_start(FrameMode /*mode*/) noexcept {
  if (running_.exchange(true)) {
    return Errc::kUnavailable;
  }
  due_ns_ = clock_.now_ns() + options_.period_ns;
  return {};
}

Result<FrameLease> SimScanner::do_next(std::chrono::nanoseconds timeout) noexcept {
  if (!running_) {
    return Errc::kUnavailable;
  }
  if (at_end()) {
    return Errc::kNotFound;
  }
  const std::int64_t deadline_ns = clock_.now_ns() + timeout.count();
  if (clock_.now_ns() < due_ns_) {
    clock_.sleep_until(std::min(due_ns_, deadline_ns));
  }
  if (!running_) {
    return Errc::kUnavailable;
  }
  if (clock_.now_ns() < due_ns_) {
    return Errc::kTimeout;
  }
  const std::uint32_t slot = slots_.take();
  if (slot == SlotPool::kNone) {  // The robot waits: the view is not lost.
    ++counters_.underruns;
    clock_.sleep_until(deadline_ns);
    return Errc::kTimeout;
  }
  return expose(slot);
}

FrameLease SimScanner::expose(std::uint32_t slot) noexcept {
  const std::size_t view = exposed_ % frames_.size();
  const std::int64_t captured_ns = clock_.now_ns();
  Bytes& buffer = buffers_[slot];
  std::memcpy(buffer.data(), frames_[view].data(), buffer.size());
  report_pose(view, captured_ns);
  const std::size_t depth_bytes = buffer.size() / 3 * 2;
  DepthFrame frame;
  frame.depth = std::span(buffer).first(depth_bytes);
  frame.gray = std::span(buffer).subspan(depth_bytes);
  frame.sequence = exposed_++;
  frame.device_ns = captured_ns;
  frame.captured_ns = captured_ns;
  frame.dequeued_ns = clock_.now_ns();
  due_ns_ = captured_ns + options_.period_ns;
  ++counters_.delivered;
  return {*this, frame, slot};
}

void SimScanner::report_pose(std::size_t view, std::int64_t captured_ns) noexcept {
  const std::int64_t half_dwell_ns = std::min<std::int64_t>(options_.period_ns / 4, 20'000'000);
  StampedPose pose;
  pose.stamp_ns = captured_ns;
  pose.of = options_.T_flange_camera ? PoseOf::kFlange : PoseOf::kCamera;
  pose.T_base_reported = views_[view].T_base_camera_reported;
  if (options_.T_flange_camera) {
    pose.T_base_reported = pose.T_base_reported * options_.T_flange_camera->inverse();
  }
  (void)robot_.stand(pose, half_dwell_ns);  // Frames are a period apart.
}

}  // namespace dseam::hal::sim
