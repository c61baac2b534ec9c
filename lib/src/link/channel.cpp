// SPDX-License-Identifier: Apache-2.0
#include "dseam/link/channel.hpp"

namespace dseam::link {
namespace {

constexpr unsigned kCounterModulusP05 = 256;
constexpr unsigned kCounterModulusP22 = 16;

/// Lengths on an FD bus; kAbort is classic everywhere.
constexpr std::array<std::uint8_t, kMessageCount> kSizeBytes = {8, 16, 32, 32, 12, 48, 48, 32, 32};

/// Heartbeats may miss what the silence limit allows; points recover by going back, so that a
/// burst of lost ones is no reason to refuse the next.
constexpr std::array<std::uint8_t, kMessageCount> kMaxDelta = {8, 4, 4, 16, 16, 64, 16, 16, 16};

constexpr std::size_t index_of(MessageId message) noexcept {
  return static_cast<std::size_t>(message);
}

}  // namespace

DataIdList data_id_list_of(MessageId message) noexcept {
  // The same for every counter: then flips of the counter are as far from a valid frame as any
  // others, and every pattern of up to three bits is detected. With differing ids some are not.
  DataIdList list;
  list.fill(static_cast<std::uint8_t>(0xA0U + static_cast<unsigned>(message)));
  return list;
}

bool Transmitter::send(MessageId message, Frame payload, Buffer<Frame>& out) noexcept {
  const std::size_t index = index_of(message);
  payload.id = addressing_.id_of(message);
  if (message == MessageId::kAbort) {
    protect_p22(payload.bytes(), data_id_list_of(message), counters_[index]);
    const bool sent = out.append(payload);
    counters_[index] = static_cast<std::uint8_t>((counters_[index] + (sent ? 1U : 0U)) & 0x0FU);
    return sent;
  }
  protect_p05(payload.bytes(), data_id_of(message), counters_[index]);
  if (!(addressing_.classic ? send_segments(message, payload, out) : out.append(payload))) {
    return false;
  }
  ++counters_[index];
  return true;
}

bool Transmitter::send_segments(MessageId message, const Frame& whole,
                                Buffer<Frame>& out) noexcept {
  const std::size_t count = segments_of(whole.size_bytes);
  if (out.capacity() - out.size() < count) {
    return false;
  }
  std::uint8_t& counter = segment_counters_[index_of(message)];
  for (std::size_t i = 0; i < count; ++i) {
    Frame segment = segment_of(whole, i);
    protect_p22(segment.bytes(), data_id_list_of(message), counter);
    counter = static_cast<std::uint8_t>((counter + 1U) & 0x0FU);
    static_cast<void>(out.append(segment));  // There is room: see above.
  }
  return true;
}

Acceptor::Acceptor(const Addressing& addressing) noexcept : addressing_(addressing) { reset(); }

void Acceptor::reset() noexcept {
  for (std::size_t i = 0; i < kMessageCount; ++i) {
    const bool abort = i == index_of(MessageId::kAbort);
    streams_[i] = Stream{};
    streams_[i].counter =
        CounterCheck(abort ? kCounterModulusP22 : kCounterModulusP05, kMaxDelta[i]);
  }
}

E2eState Acceptor::state(MessageId message) const noexcept {
  return streams_[index_of(message)].window.state();
}

std::optional<Accepted> Acceptor::accept(const Frame& frame) noexcept {
  if (frame.id - addressing_.base_id >= kMessageCount) {
    return std::nullopt;
  }
  const auto message = static_cast<MessageId>(frame.id - addressing_.base_id);
  const bool segmented = addressing_.classic && message != MessageId::kAbort;
  return segmented ? accept_segment(message, frame) : judge(message, frame);
}

Accepted Acceptor::judge(MessageId message, const Frame& whole) noexcept {
  Stream& stream = streams_[index_of(message)];
  const bool abort = message == MessageId::kAbort;
  const bool right_size = whole.size_bytes == kSizeBytes[index_of(message)] && whole.fd == !abort;
  const bool intact = right_size && (abort ? intact_p22(whole.bytes(), data_id_list_of(message))
                                           : intact_p05(whole.bytes(), data_id_of(message)));
  const std::uint8_t counter = abort ? counter_p22(whole.bytes()) : counter_p05(whole.bytes());
  const E2eStatus status = stream.counter.check(intact, counter);
  stream.window.add(status);
  return {message, status, whole};
}

std::optional<Accepted> Acceptor::accept_segment(MessageId message, const Frame& frame) noexcept {
  Stream& stream = streams_[index_of(message)];
  switch (stream.joiner.add(frame, data_id_list_of(message), kSizeBytes[index_of(message)])) {
    case SegmentJoiner::Progress::kIncomplete:
      return std::nullopt;
    case SegmentJoiner::Progress::kComplete:
      return judge(message, stream.joiner.whole());
    case SegmentJoiner::Progress::kDamaged:
      break;
  }
  stream.window.add(E2eStatus::kError);
  return Accepted{message, E2eStatus::kError, frame};
}

}  // namespace dseam::link
