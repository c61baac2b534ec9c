// SPDX-License-Identifier: Apache-2.0
#include "session/session.hpp"

#include <algorithm>
#include <bit>
#include <utility>

// The control thread's side of a session: every call here may block for seconds.

namespace dseam::hal::aravis {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kFewestBuffers = 4;

}  // namespace

AravisCamera::Session::Session(const AravisConfig& config, AravisSys& sys, Device device,
                               std::unique_ptr<ControlLine> line)
    : config_(config),
      active_(config),
      sys_(sys),
      wanted_{device.model, !config.gray, config.gray || config.gray_beside_depth},
      device_(std::move(device)),
      line_(std::move(line)),
      sequence_(device_.is_gige || config.id.starts_with("Fake") ? 1 : 0,
                device_.is_gige || config.id.starts_with("Fake") ? 65535 : UINT64_MAX >> 1U) {}

AravisCamera::Session::~Session() {
  stop();
  end_control_thread();
  disconnect();
  for (ArvBuffer* buffer : popped_) {
    if (buffer != nullptr) {
      g_object_unref(buffer);
    }
  }
}

Result<> AravisCamera::Session::prepare(std::string& problem) {
  const std::uint32_t slots = std::clamp(config_.num_buffers, kFewestBuffers, SlotPool::kMaxSlots);
  if (const auto mapped = pool_.map(slots, device_.payload_bytes); !mapped.ok()) {
    problem = "its buffers did not fit into memory; let it send a smaller image";
    return mapped;
  }
  if (const auto attached = attach(problem); !attached.ok()) {
    return attached;
  }
  control_ = std::thread([this] { run(); });
  return {};
}

Result<> AravisCamera::Session::start(FrameMode mode) {
  constexpr auto kPatience = 3s;
  if (running_.exchange(true)) {
    return Errc::kUnavailable;
  }
  mode_ = mode;
  std::unique_lock lock(mutex_);
  const std::uint32_t request = ++start_request_;
  wake_.notify_one();
  const bool answered =
      answered_.wait_for(lock, kPatience, [&] { return start_answer_ == request; });
  const Result<> result = answered ? start_result_ : Errc::kDisconnected;
  if (!result.ok()) {
    running_ = false;
  }
  return result;
}

void AravisCamera::Session::stop() noexcept {
  running_ = false;
  wake_.notify_one();
}

AravisGrant AravisCamera::Session::grant() const {
  const std::lock_guard lock(mutex_);
  return grant_;
}

void AravisCamera::Session::run() {
  while (pause(5ms)) {
    control_step();
  }
  if (acquiring_) {
    end_acquisition();
  }
  disconnect();
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  answered_.notify_all();
}

/// A camera that has not answered for longer than one access takes is gone.
void AravisCamera::Session::end_control_thread() noexcept {
  constexpr auto kPatience = 3s;
  if (!control_.joinable()) {
    return;
  }
  std::unique_lock lock(mutex_);
  quit_ = true;
  wake_.notify_one();
  const bool ended = answered_.wait_for(lock, kPatience, [&] { return ended_; });
  lock.unlock();
  if (!ended) {
    line_->cut();
  }
  control_.join();
}

/// Waits to be woken, at most `time`. False: it is time to end.
bool AravisCamera::Session::pause(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  if (!quit_) {
    wake_.wait_for(lock, time);
  }
  return !quit_;
}

void AravisCamera::Session::control_step() {
  const std::uint32_t request = latest_request();
  if (device_.stream == nullptr) {
    keep_reconnecting();
    return;
  }
  if (acquiring_ && (!running_ || request != acquired_request_)) {
    end_acquisition();
  }
  if (running_ && !acquiring_ && request != acquired_request_) {
    begin_acquisition(request);
  }
  feed();
  if (acquiring_) {
    watch();
  }
}

void AravisCamera::Session::begin_acquisition(std::uint32_t request) {
  publish(nullptr);
  for (std::uint32_t i = 0; i < pool_.num_slots(); ++i) {
    ArvBuffer* stale = sys_.pop(device_.stream.get(), 0);
    if (stale == nullptr) {
      break;
    }
    sys_.push(device_.stream.get(), stale);
  }
  publish(device_.stream.get());
  GlibError error;
  sys_.start(device_.camera.get(), error.out());
  acquiring_ = !error;
  acquired_request_ = request;
  seen_ = frames_seen();
  proven_ = false;
  begun_at_ = progress_at_ = Clock::now();
  state_ = acquiring_ ? AravisState::kStreaming : AravisState::kLost;
  answer_start(request, acquiring_ ? Result<>() : Result<>(Errc::kIo));
}

void AravisCamera::Session::answer_start(std::uint32_t request, const Result<>& result) {
  {
    const std::lock_guard lock(mutex_);
    start_result_ = result;
    start_answer_ = request;
  }
  answered_.notify_all();
}

std::uint32_t AravisCamera::Session::latest_request() const {
  const std::lock_guard lock(mutex_);
  return start_request_;
}

void AravisCamera::Session::end_acquisition() {
  GlibError error;
  sys_.stop(device_.camera.get(), error.out());
  acquiring_ = false;
  state_ = AravisState::kIdle;
}

/// Takes no lock: what came back is ours alone, and a consumer that waits for frames holds the
/// stream nearly all the time.
void AravisCamera::Session::feed() {
  std::uint32_t slots = returned_.exchange(0, std::memory_order_acquire);
  while (slots != 0) {
    const auto slot = static_cast<std::uint32_t>(std::countr_zero(slots));
    slots &= slots - 1;
    sys_.push(device_.stream.get(), popped_[slot].exchange(nullptr));
  }
}

}  // namespace dseam::hal::aravis
