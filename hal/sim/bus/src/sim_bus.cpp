// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/sim_bus.hpp"

#include <algorithm>

namespace dseam::hal::sim {
namespace {

/// How often a waiting receiver looks whether another thread has sent something.
constexpr std::int64_t kLookNs = 200'000;

/// Bits of a frame besides its data, and how much stuffing may add.
constexpr double kClassicOverheadBits = 47.0;
constexpr double kFdArbitrationBits = 30.0;
constexpr double kFdDataOverheadBits = 33.0;
constexpr double kWorstStuffing = 1.25;

}  // namespace

SimBus::SimBus(const Config& config, Clock& clock)
    : config_(config), clock_(clock), random_(config.seed) {}

SimBus::Endpoint& SimBus::connect() {
  const std::lock_guard lock(mutex_);
  ports_.emplace_back(config_);
  return endpoints_.emplace_back(*this, ports_.size() - 1);
}

void SimBus::set_faults(const BusFaults& faults) noexcept {
  const std::lock_guard lock(mutex_);
  faults_ = faults;
}

void SimBus::set_state(BusState state) noexcept {
  const std::lock_guard lock(mutex_);
  state_ = state;
  for (Port& port : ports_) {
    port.health.state = state;
    if (gone()) {
      port.to_send.clear();
      port.inbox.clear();
    }
  }
}

BusFaultCounts SimBus::fault_counts() const noexcept {
  const std::lock_guard lock(mutex_);
  return counts_;
}

std::int64_t SimBus::wire_ns(const CanFrame& frame) const noexcept {
  const double data_bits = 8.0 * frame.size_bytes;
  const double arbitration = frame.fd ? kFdArbitrationBits : kClassicOverheadBits + data_bits;
  const double data = frame.fd ? kFdDataOverheadBits + data_bits : 0.0;
  return static_cast<std::int64_t>(
      1e9 * kWorstStuffing * (arbitration / config_.bits_per_s + data / config_.data_bits_per_s));
}

void SimBus::advance(std::int64_t now_ns) noexcept {
  while (transmit_next(now_ns)) {
  }
}

/// Arbitration: of the frames that wait when the wire falls free, the lowest identifier wins.
bool SimBus::transmit_next(std::int64_t now_ns) noexcept {
  std::int64_t start_ns = INT64_MAX;
  for (const Port& port : ports_) {
    start_ns = std::min(start_ns, std::max(free_ns_, port.to_send.oldest_ns().value_or(INT64_MAX)));
  }
  if (start_ns > now_ns) {
    return false;
  }
  std::size_t winner = ports_.size();
  SendQueue::Slot* first = nullptr;
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    SendQueue::Slot* candidate = ports_[i].to_send.front(start_ns);
    if (candidate != nullptr && (first == nullptr || candidate->frame.id < first->frame.id)) {
      first = candidate;
      winner = i;
    }
  }
  if (first == nullptr) {
    return true;  // What waited was too old; look again.
  }
  CanFrame frame = first->frame;
  ports_[winner].to_send.erase(*first);
  ++ports_[winner].health.confirmed;
  free_ns_ = start_ns + wire_ns(frame);
  frame.stamp_ns = free_ns_;
  deliver(frame, winner);
  return true;
}

void SimBus::deliver(CanFrame frame, std::size_t from) noexcept {
  if (happens(faults_.lost, counts_.lost)) {
    return;
  }
  const CanFrame clean = frame;
  if (happens(faults_.stuck, counts_.stuck)) {
    const std::int64_t stamp_ns = frame.stamp_ns;
    frame = before_;
    frame.stamp_ns = stamp_ns;
  }
  before_ = clean;
  spoil(frame);
  if (happens(faults_.delayed, counts_.delayed)) {
    frame.stamp_ns +=
        static_cast<std::int64_t>(random_.uniform() * static_cast<double>(faults_.most_delay_ns));
  }
  put_in_inboxes(frame, from);
  if (happens(faults_.duplicated, counts_.duplicated)) {
    put_in_inboxes(frame, from);
  }
}

void SimBus::put_in_inboxes(const CanFrame& frame, std::size_t from) noexcept {
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    Port& port = ports_[i];
    if (i == from) {
      continue;
    }
    if (port.inbox.size() == config_.receive_queue) {
      ++port.health.receive_overflow;
      continue;
    }
    const auto place =
        std::ranges::upper_bound(port.inbox, frame.stamp_ns, {}, &CanFrame::stamp_ns);
    port.inbox.insert(place, frame);
  }
}

bool SimBus::happens(double probability, std::uint64_t& count) noexcept {
  const bool yes = probability > 0.0 && random_.uniform() < probability;
  count += yes ? 1U : 0U;
  return yes;
}

void SimBus::spoil(CanFrame& frame) noexcept {
  if (happens(faults_.flipped, counts_.flipped)) {
    flip_bits(frame);
  }
  if (happens(faults_.garbage, counts_.garbage)) {
    make_noise(frame);
  }
  if (happens(faults_.truncated, counts_.truncated)) {
    frame.size_bytes = static_cast<std::uint8_t>(random_.below(frame.size_bytes));
  }
  if (happens(faults_.wrong, counts_.wrong)) {
    frame.id ^= 1U + random_.below(7);
  }
}

void SimBus::flip_bits(CanFrame& frame) noexcept {
  const std::uint32_t bits = std::uint32_t{frame.size_bytes} * 8U;
  const bool burst = random_.below(2) == 1;
  const std::uint32_t start = random_.below(bits);
  const std::uint32_t pattern = burst ? random_.below(0x10000) | 1U : 1U;
  for (std::uint32_t i = 0; i < 16 && start + i < bits; ++i) {
    if (((pattern >> i) & 1U) != 0) {
      frame.data[(start + i) / 8] ^= static_cast<std::byte>(0x80U >> ((start + i) % 8));
    }
  }
  for (std::uint32_t more = burst ? 0 : random_.below(3); more > 0; --more) {
    const std::uint32_t bit = random_.below(bits);
    frame.data[bit / 8] ^= static_cast<std::byte>(0x80U >> (bit % 8));
  }
}

void SimBus::make_noise(CanFrame& frame) noexcept {
  for (std::size_t i = 0; i < frame.size_bytes; ++i) {
    frame.data[i] = static_cast<std::byte>(random_.below(256));
  }
}

Result<> SimBus::Endpoint::do_send(const CanFrame& frame) noexcept {
  const std::lock_guard lock(bus_.mutex_);
  if (bus_.gone()) {
    return Errc::kDisconnected;
  }
  if (frame.fd && !bus_.config_.fd) {
    return Errc::kUnsupported;
  }
  const std::int64_t now_ns = bus_.clock_.now_ns();
  bus_.advance(now_ns);
  Port& port = bus_.ports_[index_];
  if (!port.to_send.push(frame, now_ns, now_ns + bus_.config_.send_deadline_ns)) {
    return Errc::kQueueFull;
  }
  ++port.health.sent;
  return {};
}

Result<CanFrame> SimBus::Endpoint::do_receive(std::chrono::nanoseconds timeout) noexcept {
  const std::int64_t deadline_ns = bus_.clock_.now_ns() + timeout.count();
  while (true) {
    std::int64_t wake_ns = 0;
    {
      const std::lock_guard lock(bus_.mutex_);
      if (bus_.gone()) {
        return Errc::kDisconnected;
      }
      const std::int64_t now_ns = bus_.clock_.now_ns();
      bus_.advance(now_ns);
      Port& port = bus_.ports_[index_];
      if (!port.inbox.empty() && port.inbox.front().stamp_ns <= now_ns) {
        const CanFrame frame = port.inbox.front();
        port.inbox.erase(port.inbox.begin());
        ++port.health.received;
        return frame;
      }
      if (now_ns >= deadline_ns) {
        return Errc::kTimeout;
      }
      wake_ns = std::min(deadline_ns, now_ns + kLookNs);
    }
    bus_.clock_.sleep_until(wake_ns);
  }
}

Result<> SimBus::Endpoint::do_purge() noexcept {
  const std::lock_guard lock(bus_.mutex_);
  bus_.advance(bus_.clock_.now_ns());
  bus_.ports_[index_].to_send.clear();
  return {};
}

BusHealth SimBus::Endpoint::do_health() const noexcept {
  const std::lock_guard lock(bus_.mutex_);
  BusHealth health = bus_.ports_[index_].health;
  health.send_dropped = bus_.ports_[index_].to_send.dropped();
  return health;
}

}  // namespace dseam::hal::sim
