// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "device/device.hpp"
#include "dseam/base/random.hpp"
#include "dseam/hal/aravis/aravis_camera.hpp"
#include "dseam/hal/camera/camera_counters.hpp"
#include "dseam/hal/camera/frame_sequence.hpp"
#include "dseam/hal/camera/slot_pool.hpp"
#include "session/frame_images.hpp"
#include "session/frame_pool.hpp"

namespace dseam::hal::aravis {

/// A camera over all its connections: the control thread that keeps it alive, and the frames.
///
/// What is shared: the control thread owns the device and lends the consumer its stream through
/// `stream_`, under a mutex that neither holds for more than a slice of 10 ms. Buffers that come
/// back are only marked; the control thread hands them to Aravis.
class AravisCamera::Session {
 public:
  Session(const AravisConfig& config, AravisSys& sys, Device device,
          std::unique_ptr<ControlLine> line);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Makes the buffers and the stream, and starts the control thread.
  Result<> prepare(std::string& problem);
  Result<> start(FrameMode mode);
  void stop() noexcept;
  /// The next good frame and its slot.
  Result<DepthFrame> next(std::chrono::nanoseconds timeout, std::uint32_t& slot) noexcept;
  void give_back(std::uint32_t slot) noexcept;

  [[nodiscard]] const depth::DepthModel& model() const noexcept { return wanted_.model; }
  [[nodiscard]] CameraHealth health() const noexcept { return counters_.snapshot(); }
  [[nodiscard]] AravisState state() const noexcept { return state_; }
  [[nodiscard]] AravisGrant grant() const;

 private:
  using Clock = std::chrono::steady_clock;

  // The consumer's side.
  /// One frame as it was popped, with its images when it is whole.
  struct Popped {
    ArvBuffer* buffer = nullptr;
    AravisSys::Arrival arrival;
    std::optional<FrameImages> images;
  };
  Popped pop(Clock::time_point deadline) noexcept;
  Popped newest(Popped oldest) noexcept;
  Popped examine(ArvBuffer* buffer) noexcept;
  DepthFrame frame_of(const Popped& popped) noexcept;
  void drop(ArvBuffer* buffer) noexcept;
  void count_gap(std::uint64_t frame_id) noexcept;

  // The control thread's side.
  void run();
  void end_control_thread() noexcept;
  void control_step();
  void begin_acquisition(std::uint32_t request);
  void answer_start(std::uint32_t request, const Result<>& result);
  [[nodiscard]] std::uint32_t latest_request() const;
  void end_acquisition();
  void feed();
  void watch();
  void judge_silence(double silent_periods);
  [[nodiscard]] std::uint64_t count(const char* counter);
  [[nodiscard]] std::uint64_t frames_seen();
  void disconnect();
  bool reconnect_once();
  void keep_reconnecting();
  Result<> attach(std::string& problem);
  void publish(ArvStream* stream);
  [[nodiscard]] bool pause(std::chrono::milliseconds time);

  const AravisConfig config_;
  AravisConfig active_;  ///< With what was learned, such as a smaller packet.
  AravisSys& sys_;
  WantedImages wanted_;
  Device device_;
  const std::unique_ptr<ControlLine> line_;
  FramePool pool_;
  CameraCounters counters_;
  FrameSequence sequence_;
  std::uint32_t missing_ = 0;
  std::int64_t last_captured_ns_ = 0;
  /// The consumer's until returned.
  std::array<std::atomic<ArvBuffer*>, SlotPool::kMaxSlots> popped_{};

  std::atomic<AravisState> state_{AravisState::kIdle};
  std::atomic<bool> running_{false};
  std::atomic<FrameMode> mode_{FrameMode::kEvery};
  std::atomic<std::uint32_t> returned_{0};  ///< Slots on their way back to Aravis.
  std::atomic<bool> control_lost_{false};
  std::atomic<bool> handing_over_{false};
  std::atomic<bool> reconnected_{false};
  std::atomic<bool> loss_unreported_{false};  ///< The consumer hears of every loss, however short.

  mutable std::mutex stream_mutex_;
  ArvStream* stream_ = nullptr;

  mutable std::mutex mutex_;  ///< What follows, and the wish to start.
  std::condition_variable wake_;
  std::condition_variable answered_;
  bool quit_ = false;
  bool ended_ = false;  ///< The control thread has let go of the camera.
  std::uint32_t start_request_ = 0;
  std::uint32_t start_answer_ = 0;
  Result<> start_result_;
  AravisGrant grant_;

  bool acquiring_ = false;
  std::uint32_t acquired_request_ = 0;
  std::uint64_t seen_ = 0;
  bool proven_ = false;
  Clock::time_point begun_at_;
  Clock::time_point progress_at_;
  Pcg32 jitter_{0x5eed};
  std::thread control_;
};

}  // namespace dseam::hal::aravis
