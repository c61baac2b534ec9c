// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "session/session.hpp"

// The control thread's side of a session: whether frames come, and making the connection again.

namespace dseam::hal::aravis {
namespace {

using namespace std::chrono_literals;

void on_control_lost(ArvDevice* /*device*/, gpointer flag) {
  static_cast<std::atomic<bool>*>(flag)->store(true);
}

}  // namespace

std::uint64_t AravisCamera::Session::count(const char* counter) {
  return sys_.count(device_.stream.get(), counter);
}

std::uint64_t AravisCamera::Session::frames_seen() {
  return count("n_completed_buffers") + count("n_failures") + count("n_underruns");
}

void AravisCamera::Session::watch() {
  const std::uint64_t seen = frames_seen();
  if (seen != seen_) {
    seen_ = seen;
    progress_at_ = Clock::now();
    state_ = AravisState::kStreaming;
    counters_.underruns = count("n_underruns");
    if (!proven_ && count("n_completed_buffers") > 0) {
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
  line_->release();
}

/// Makes the stream and gives it every buffer that is not on loan.
Result<> AravisCamera::Session::attach(std::string& problem) {
  if (const auto made = make_stream(device_, active_, sys_, problem); !made.ok()) {
    return made;
  }
  control_lost_ = false;
  g_signal_connect(arv_camera_get_device(device_.camera.get()), "control-lost",
                   G_CALLBACK(on_control_lost), &control_lost_);
  for (std::uint32_t slot = 0; slot < pool_.num_slots(); ++slot) {
    if (popped_[slot] == nullptr) {
      sys_.push(device_.stream.get(), arv_buffer_new_full(pool_.payload_bytes(), pool_.slot(slot),
                                                          GUINT_TO_POINTER(slot), nullptr));
    }
  }
  const std::lock_guard lock(mutex_);
  grant_ = device_.grant;
  return {};
}

void AravisCamera::Session::keep_reconnecting() {
  constexpr double kLongestMs = 5000.0;
  auto wait_ms = static_cast<double>(config_.first_retry.count());
  const bool was_lost = state_ == AravisState::kLost;
  while (!reconnect_once()) {
    answer_start(latest_request(), Errc::kDisconnected);
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
  auto device = connect(active_, sys_, *line_, problem);
  if (!device.ok() || device.value().payload_bytes != pool_.payload_bytes() ||
      device.value().model.format != wanted_.model.format) {
    return false;
  }
  device_ = std::move(device.value());
  if (!attach(problem).ok()) {
    disconnect();
    return false;
  }
  reconnected_ = true;
  if (running_) {
    begin_acquisition(latest_request());
    if (!acquiring_) {
      disconnect();
      return false;
    }
  }
  return true;
}

}  // namespace dseam::hal::aravis
