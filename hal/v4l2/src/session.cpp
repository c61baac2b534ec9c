// SPDX-License-Identifier: Apache-2.0
#include "session.hpp"

#include <algorithm>
#include <utility>

#include "dseam/depth/frame_decoder.hpp"

// Opening, starting, stopping, and the control thread that opens again.

namespace dseam::hal::v4l2 {
namespace {

using namespace std::chrono_literals;

constexpr auto kLongestRetry = 5000ms;

}  // namespace

V4l2Camera::Session::~Session() {
  stop();
  {
    const std::lock_guard lock(wake_mutex_);
    quit_ = true;
  }
  wake_.notify_one();
  if (control_.joinable()) {
    control_.join();
  }
  const auto lock = claim();
  take_back_returned();
  let_go();
  for (Slot& slot : slots_) {
    if (slot.mapping.start != nullptr) {
      (void)sys_.unmap(slot.mapping);
    }
  }
}

Result<> V4l2Camera::Session::open(std::string& problem) {
  auto stream = std::make_unique<VideoStream>(sys_);
  if (const auto opened = stream->open(config_, problem); !opened.ok()) {
    return opened;
  }
  const v4l2_pix_format& format = stream->format();
  model_ = config_.model;
  model_.intrinsics.width = format.width;
  model_.intrinsics.height = format.height;
  if (const auto fits = config_.gray ? fit_gray(format) : fit_depth(format); !fits.ok()) {
    problem = config_.gray ? "its image is not gray with one byte a pixel"
                           : "its image is no depth image, or the configuration does not give its "
                             "scale and focal length";
    return fits;
  }
  grant_ = stream->grant();
  adopt(std::move(stream));
  control_ = std::thread([this] { run(); });
  return {};
}

Result<> V4l2Camera::Session::fit_depth(const v4l2_pix_format& format) {
  const auto sample = depth::format_from_fourcc(format.pixelformat);
  if (!sample.ok()) {
    return Errc::kUnsupported;
  }
  model_.format = sample.value();
  model_.row_stride_bytes = format.bytesperline;
  frame_bytes_ = depth::depth_bytes(model_);
  const bool fits = frame_bytes_ <= format.sizeimage && depth::FrameDecoder::make(model_).ok();
  return fits ? Result<>() : Errc::kInvalidArgument;
}

Result<> V4l2Camera::Session::fit_gray(const v4l2_pix_format& format) {
  const bool known = format.pixelformat == V4L2_PIX_FMT_GREY ||
                     format.pixelformat == depth::fourcc('Y', '8', ' ', ' ');
  if (!known) {
    return Errc::kUnsupported;
  }
  model_.has_gray = true;
  model_.gray_row_stride_bytes = format.bytesperline;
  frame_bytes_ = depth::gray_bytes(model_);
  return frame_bytes_ > 0 && frame_bytes_ <= format.sizeimage ? Result<>()
                                                              : Result<>(Errc::kInvalidArgument);
}

/// The consumer sees that somebody wants the stream and lets go of it.
std::unique_lock<std::mutex> V4l2Camera::Session::claim() noexcept {
  claimed_ = true;
  std::unique_lock lock(stream_mutex_);
  claimed_ = false;
  return lock;
}

Result<> V4l2Camera::Session::start(FrameMode mode) noexcept {
  if (running_.exchange(true)) {
    return Errc::kUnavailable;
  }
  const auto lock = claim();
  mode_ = mode;
  if (stream_ == nullptr || failed_) {
    running_ = false;
    return Errc::kDisconnected;
  }
  if (begin() < 0) {
    running_ = false;
    fail();
    return Errc::kIo;
  }
  return {};
}

/// Queues every buffer that is not on loan and lets the driver run; under stream_mutex_.
int V4l2Camera::Session::begin() noexcept {
  take_back_returned();
  for (Slot& slot : slots_) {
    if (slot.current && !slot.lent && !slot.queued) {
      const int error = stream_->queue(slot.index);
      if (error < 0) {
        return error;
      }
      slot.queued = true;
      ++num_queued_;
    }
  }
  const int error = stream_->start();
  streaming_ = error >= 0;
  state_ = streaming_ ? V4l2State::kStreaming : V4l2State::kLost;
  silent_since_ = Clock::time_point::max();
  return error;
}

void V4l2Camera::Session::stop() noexcept {
  if (!running_.exchange(false)) {
    return;
  }
  const auto lock = claim();
  if (!std::exchange(streaming_, false)) {
    return;
  }
  state_ = V4l2State::kIdle;
  if (stream_->stop() < 0) {
    fail();
    return;
  }
  num_queued_ = 0;  // Stopping takes every buffer back from the driver.
  for (Slot& slot : slots_) {
    slot.queued = false;
  }
  sequence_.restart();
}

void V4l2Camera::Session::run() {
  auto retry = config_.first_retry;
  while (pause(failed_ ? retry : 100ms)) {
    if (!failed_) {
      continue;
    }
    {
      const auto lock = claim();
      let_go();
    }
    retry = reopen_once() ? config_.first_retry
                          : std::min<std::chrono::milliseconds>(2 * retry, kLongestRetry);
  }
}

/// Waits to be woken, at most `time`. False: it is time to end.
bool V4l2Camera::Session::pause(std::chrono::milliseconds time) {
  std::unique_lock lock(wake_mutex_);
  if (!quit_) {
    wake_.wait_for(lock, time);
  }
  return !quit_;
}

/// Ends the connection; what is out on loan stays mapped until it comes back.
void V4l2Camera::Session::let_go() noexcept {
  if (stream_ == nullptr) {
    return;
  }
  (void)stream_->stop();
  for (Slot& slot : slots_) {
    if (slot.current && !slot.lent) {
      (void)sys_.unmap(std::exchange(slot, Slot{}).mapping);
    }
    slot.current = false;
    slot.queued = false;
  }
  num_queued_ = 0;
  stream_.reset();
}

bool V4l2Camera::Session::reopen_once() {
  std::string problem;
  auto stream = std::make_unique<VideoStream>(sys_);
  const bool same = stream->open(config_, problem).ok() && stream->grant().card == grant_.card &&
                    stream->grant().bus_info == grant_.bus_info &&
                    stream->format().width == model_.intrinsics.width &&
                    stream->format().height == model_.intrinsics.height &&
                    stream->format().bytesperline ==
                        (config_.gray ? model_.gray_row_stride_bytes : model_.row_stride_bytes);
  if (!same) {
    return false;
  }
  const auto lock = claim();
  adopt(std::move(stream));
  failed_ = false;
  queue_failures_ = 0;
  sequence_.restart();
  if (running_ && begin() < 0) {
    fail();
    return false;
  }
  state_ = running_ ? V4l2State::kStreaming : V4l2State::kIdle;
  ++counters_.reconnects;
  return true;
}

/// Gives the stream's mappings places that no loan occupies. Those that find none stay with the
/// stream and are not used.
void V4l2Camera::Session::adopt(std::unique_ptr<VideoStream> stream) noexcept {
  stream_ = std::move(stream);
  std::uint32_t index = 0;
  for (Slot& slot : slots_) {
    if (slot.mapping.start == nullptr && index < stream_->num_buffers()) {
      slot = {.mapping = stream_->release(index), .index = index, .current = true};
      ++index;
    }
  }
}

}  // namespace dseam::hal::v4l2
