// SPDX-License-Identifier: Apache-2.0
#include "session.hpp"

#include <algorithm>
#include <bit>
#include <utility>

// The control thread's side of a session: every call here may block for seconds.

namespace dseam::hal::aravis {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kFewestBuffers = 4;

void on_control_lost(ArvDevice* /*device*/, gpointer flag) {
  static_cast<std::atomic<bool>*>(flag)->store(true);
}

std::uint64_t info(ArvStream* stream, const char* name) {
  return arv_stream_get_info_uint64_by_name(stream, name);
}

}  // namespace

AravisCamera::Session::Session(const AravisConfig& config, Device device)
    : config_(config),
      active_(config),
      model_(device.model),
      image_bytes_(device.image_bytes),
      device_(std::move(device)),
      sequence_(device_.is_gige || config.id.starts_with("Fake") ? 1 : 0,
                device_.is_gige || config.id.starts_with("Fake") ? 65535 : UINT64_MAX >> 1U) {}

AravisCamera::Session::~Session() {
  stop();
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  wake_.notify_one();
  if (control_.joinable()) {
    control_.join();
  }
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
    problem = "its buffers did not fit into memory; lower camera.num_buffers";
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
  std::uint32_t request = 0;
  {
    const std::lock_guard lock(mutex_);
    request = start_request_;
  }
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
  while (ArvBuffer* stale = arv_stream_try_pop_buffer(device_.stream.get())) {
    arv_stream_push_buffer(device_.stream.get(), stale);
  }
  publish(device_.stream.get());
  GlibError error;
  arv_camera_start_acquisition(device_.camera.get(), error.out());
  acquiring_ = !error;
  acquired_request_ = request;
  seen_ = frames_seen();
  proven_ = false;
  begun_at_ = progress_at_ = Clock::now();
  state_ = acquiring_ ? AravisState::kStreaming : AravisState::kLost;
  {
    const std::lock_guard lock(mutex_);
    start_result_ = acquiring_ ? Result<>() : Result<>(Errc::kIo);
    start_answer_ = request;
  }
  answered_.notify_all();
}

void AravisCamera::Session::end_acquisition() {
  GlibError error;
  arv_camera_stop_acquisition(device_.camera.get(), error.out());
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
    arv_stream_push_buffer(device_.stream.get(), std::exchange(popped_[slot], nullptr));
  }
}

std::uint64_t AravisCamera::Session::frames_seen() const {
  ArvStream* stream = device_.stream.get();
  return info(stream, "n_completed_buffers") + info(stream, "n_failures") +
         info(stream, "n_underruns");
}

void AravisCamera::Session::watch() {
  const std::uint64_t seen = frames_seen();
  if (seen != seen_) {
    seen_ = seen;
    progress_at_ = Clock::now();
    state_ = AravisState::kStreaming;
    counters_.underruns = info(device_.stream.get(), "n_underruns");
    if (!proven_ && info(device_.stream.get(), "n_completed_buffers") > 0) {
      proven_ = true;
      read_back_socket_buffer(device_, active_);
      const std::lock_guard lock(mutex_);
      grant_ = device_.grant;
    }
  }
  const std::chrono::duration<double> silent = Clock::now() - progress_at_;
  judge_silence(silent.count());
}

void AravisCamera::Session::judge_silence(double silent_s) {
  constexpr double kLeastS = 0.5;
  constexpr std::uint32_t kSafePacketBytes = 1400;
  const std::chrono::duration<double> first_frame = config_.first_frame;
  // The small packets at both ends of a frame get through: it is not silent, but never whole.
  const std::chrono::duration<double> tried = Clock::now() - begun_at_;
  const bool path_too_narrow = device_.is_gige && !proven_ &&
                               device_.grant.packet_bytes > kSafePacketBytes && tried > first_frame;
  if (path_too_narrow) {
    active_.packet_bytes = kSafePacketBytes;
    disconnect();
    return;
  }
  const double patience_s = proven_ ? 0.0 : first_frame.count();
  const double lost_s =
      std::max({kLeastS, config_.lost_periods * device_.period_s, 2.0 * patience_s});
  if (control_lost_ || silent_s > lost_s) {
    state_ = AravisState::kLost;
    loss_unreported_ = true;
    disconnect();
  } else if (silent_s > config_.stalled_periods * device_.period_s + patience_s) {
    state_ = AravisState::kStalled;
  }
}

void AravisCamera::Session::publish(ArvStream* stream) {
  handing_over_ = true;
  const std::lock_guard lock(stream_mutex_);
  stream_ = stream;
  handing_over_ = false;
}

void AravisCamera::Session::disconnect() {
  publish(nullptr);
  acquiring_ = false;
  if (device_.camera != nullptr) {
    g_signal_handlers_disconnect_by_data(arv_camera_get_device(device_.camera.get()),
                                         &control_lost_);
  }
  device_.stream.reset();  // Joins Aravis' thread: from here on nobody writes to the pool.
  device_.camera.reset();
}

/// Makes the stream and gives it every buffer that is not on loan.
Result<> AravisCamera::Session::attach(std::string& problem) {
  if (const auto made = make_stream(device_, active_, problem); !made.ok()) {
    return made;
  }
  control_lost_ = false;
  g_signal_connect(arv_camera_get_device(device_.camera.get()), "control-lost",
                   G_CALLBACK(on_control_lost), &control_lost_);
  for (std::uint32_t slot = 0; slot < pool_.num_slots(); ++slot) {
    if (popped_[slot] == nullptr) {
      arv_stream_push_buffer(device_.stream.get(),
                             arv_buffer_new_full(pool_.payload_bytes(), pool_.slot(slot),
                                                 GUINT_TO_POINTER(slot), nullptr));
    }
  }
  const std::lock_guard lock(mutex_);
  grant_ = device_.grant;
  return {};
}

void AravisCamera::Session::keep_reconnecting() {
  constexpr double kFirstMs = 200.0;
  constexpr double kLongestMs = 5000.0;
  double wait_ms = kFirstMs;
  const bool was_lost = state_ == AravisState::kLost;
  while (!reconnect_once()) {
    const double jittered_ms = wait_ms * (0.8 + 0.4 * jitter_.uniform());
    const auto until = Clock::now() + std::chrono::milliseconds(static_cast<int>(jittered_ms));
    while (Clock::now() < until) {
      if (!pause(20ms)) {
        return;
      }
    }
    wait_ms = std::min(kLongestMs, 2.0 * wait_ms);
  }
  counters_.reconnects += was_lost ? 1U : 0U;
}

bool AravisCamera::Session::reconnect_once() {
  std::string problem;
  auto device = connect(active_, problem);
  if (!device.ok() || device.value().payload_bytes != pool_.payload_bytes() ||
      device.value().model.format != model_.format) {
    return false;
  }
  device_ = std::move(device.value());
  if (!attach(problem).ok()) {
    disconnect();
    return false;
  }
  reconnected_ = true;
  if (running_) {
    begin_acquisition(acquired_request_);
  }
  return true;
}

}  // namespace dseam::hal::aravis
