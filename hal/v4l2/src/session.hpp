// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/videodev2.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "dseam/hal/camera/camera_counters.hpp"
#include "dseam/hal/camera/frame_sequence.hpp"
#include "dseam/hal/camera/slot_pool.hpp"
#include "dseam/hal/v4l2/v4l2_camera.hpp"
#include "video_stream.hpp"

namespace dseam::hal::v4l2 {

/// A camera over all its connections: frames for the consumer, and the thread that reopens.
///
/// Whoever holds `stream_mutex_` may use the stream; the consumer lets go of it every 10 ms.
class V4l2Camera::Session {
 public:
  Session(const V4l2Config& config, V4l2Sys& sys) : config_(config), sys_(sys) {}
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  Result<> open(std::string& problem);
  Result<> start(FrameMode mode) noexcept;
  void stop() noexcept;
  Result<DepthFrame> next(std::chrono::nanoseconds timeout, std::uint32_t& slot) noexcept;
  void give_back(std::uint32_t slot) noexcept;

  [[nodiscard]] const depth::DepthModel& model() const noexcept { return model_; }
  [[nodiscard]] CameraHealth health() const noexcept { return counters_.snapshot(); }
  [[nodiscard]] V4l2State state() const noexcept { return state_; }
  [[nodiscard]] V4l2Grant grant() const { return grant_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// Where a buffer's mapping is kept; it may outlive the connection that it came from.
  struct Slot {
    V4l2Sys::Mapping mapping;
    std::uint32_t index = 0;
    bool current = false;  ///< Of the connection that is open now.
    bool queued = false;   ///< With the driver.
    bool lent = false;     ///< With the consumer.
  };
  struct Taken {
    v4l2_buffer buffer;
    std::uint32_t slot;
    DepthFrame frame;
  };

  // The consumer's side; under stream_mutex_ but for next() and give_back().
  std::optional<Taken> take(Clock::time_point deadline) noexcept;
  std::optional<Taken> dequeue() noexcept;
  Taken newest(Taken oldest) noexcept;
  bool wait_for_driver(int slice_ms) noexcept;
  [[nodiscard]] bool is_whole(const v4l2_buffer& buffer) const noexcept;
  void count_gap(const v4l2_buffer& buffer) noexcept;
  DepthFrame frame_of(const Taken& taken) noexcept;
  void take_back(std::uint32_t slot) noexcept;
  void take_back_returned() noexcept;
  void queue(Slot& slot) noexcept;
  void fail() noexcept;

  Result<> fit_depth(const v4l2_pix_format& format);
  Result<> fit_gray(const v4l2_pix_format& format);

  // The control thread's side.
  void run();
  [[nodiscard]] bool pause(std::chrono::milliseconds time);
  void let_go() noexcept;
  bool reopen_once();
  void adopt(std::unique_ptr<VideoStream> stream) noexcept;
  [[nodiscard]] int begin() noexcept;
  [[nodiscard]] std::unique_lock<std::mutex> claim() noexcept;

  const V4l2Config config_;
  V4l2Sys& sys_;
  depth::DepthModel model_;
  std::size_t frame_bytes_ = 0;
  V4l2Grant grant_;
  CameraCounters counters_;

  std::mutex stream_mutex_;
  std::unique_ptr<VideoStream> stream_;
  std::array<Slot, SlotPool::kMaxSlots> slots_{};
  std::uint32_t num_queued_ = 0;
  std::uint32_t queue_failures_ = 0;
  bool starved_ = false;
  bool streaming_ = false;
  FrameMode mode_ = FrameMode::kEvery;
  FrameSequence sequence_{0, UINT32_MAX};
  std::uint32_t missing_ = 0;
  std::int64_t last_captured_ns_ = 0;
  Clock::time_point silent_since_ = Clock::time_point::max();

  std::atomic<V4l2State> state_{V4l2State::kIdle};
  std::atomic<bool> running_{false};
  std::atomic<bool> claimed_{false};
  std::atomic<bool> failed_{false};
  std::atomic<bool> loss_unreported_{false};  ///< The consumer hears of every loss, however short.
  std::atomic<std::uint32_t> returned_{0};

  std::mutex wake_mutex_;
  std::condition_variable wake_;
  bool quit_ = false;
  std::thread control_;
};

}  // namespace dseam::hal::v4l2
