// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/candump/recording_bus.hpp"

#include "dseam/hal/candump/candump_format.hpp"

namespace dseam::hal::candump {

bool RecordingBus::Ring::push(const CanFrame& frame) noexcept {
  const std::size_t written = written_.load(std::memory_order_relaxed);
  if (written - read_.load(std::memory_order_acquire) == frames_.size()) {
    return false;
  }
  frames_[written % frames_.size()] = frame;
  written_.store(written + 1, std::memory_order_release);
  return true;
}

const CanFrame* RecordingBus::Ring::front() const noexcept {
  const std::size_t read = read_.load(std::memory_order_relaxed);
  const bool empty = read == written_.load(std::memory_order_acquire);
  return empty ? nullptr : &frames_[read % frames_.size()];
}

RecordingBus::RecordingBus(CanBus& bus, Clock& clock, std::string interface, std::size_t capacity)
    : bus_(bus),
      clock_(clock),
      interface_(std::move(interface)),
      sent_(capacity),
      received_(capacity) {}

void RecordingBus::record(Ring& ring, const CanFrame& frame) noexcept {
  if (!ring.push(frame)) {
    not_recorded_.fetch_add(1, std::memory_order_relaxed);
  }
}

Result<> RecordingBus::do_send(const CanFrame& frame) noexcept {
  const Result<> sent = bus_.send(frame);
  if (sent.ok()) {
    CanFrame stamped = frame;
    stamped.stamp_ns = clock_.now_ns();
    record(sent_, stamped);
  }
  return sent;
}

Result<CanFrame> RecordingBus::do_receive(std::chrono::nanoseconds timeout) noexcept {
  const Result<CanFrame> received = bus_.receive(timeout);
  if (received.ok()) {
    record(received_, received.value());
  }
  return received;
}

Result<> RecordingBus::flush(std::FILE* log) {
  while (true) {
    const CanFrame* sent = sent_.front();
    const CanFrame* received = received_.front();
    if (sent == nullptr && received == nullptr) {
      return std::fflush(log) == 0 ? Result<>() : Errc::kIo;
    }
    const bool sent_first =
        received == nullptr || (sent != nullptr && sent->stamp_ns <= received->stamp_ns);
    const std::string line = to_line(sent_first ? *sent : *received, interface_) + "\n";
    if (std::fputs(line.c_str(), log) == EOF) {
      return Errc::kIo;
    }
    (sent_first ? sent_ : received_).pop();
  }
}

}  // namespace dseam::hal::candump
