// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/hal/bus/send_queue.hpp"
#include "dseam/hal/can_bus.hpp"
#include "dseam/hal/clock.hpp"

namespace dseam::hal::sim {

/// How often the bus misbehaves: a probability for each frame and kind.
struct BusFaults {
  double lost = 0.0;
  double duplicated = 0.0;
  double delayed = 0.0;    ///< Up to `most_delay_ns`; what comes after overtakes it.
  double flipped = 0.0;    ///< 1 to 3 bits anywhere, or a burst of up to 16.
  double garbage = 0.0;    ///< The data is replaced by noise.
  double truncated = 0.0;  ///< The data ends early.
  double stuck = 0.0;      ///< The frame before is delivered in its place.
  double wrong = 0.0;      ///< Another identifier.
  std::int64_t most_delay_ns = 5'000'000;
};

/// Faults that happened, by kind.
struct BusFaultCounts {
  std::uint64_t lost = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t delayed = 0;
  std::uint64_t flipped = 0;
  std::uint64_t garbage = 0;
  std::uint64_t truncated = 0;
  std::uint64_t stuck = 0;
  std::uint64_t wrong = 0;

  [[nodiscard]] std::uint64_t total() const noexcept {
    return lost + duplicated + delayed + flipped + garbage + truncated + stuck + wrong;
  }
};

/// A CAN bus in memory: frames take their time on the wire, the lowest identifier goes first, and
/// every endpoint hears what the others send. Runs on whatever time its clock tells.
///
/// Memory:  queues are made at construction and by connect().
/// Context: each endpoint as CanBus says; connect() at set-up only.
class SimBus {
 public:
  struct Config {
    bool fd = true;
    std::uint32_t bits_per_s = 1'000'000;
    std::uint32_t data_bits_per_s = 5'000'000;  ///< FD frames' data.
    std::size_t send_queue = 64;
    std::size_t receive_queue = 1024;
    std::int64_t send_deadline_ns = 50'000'000;  ///< Older frames are dropped, not sent.
    std::uint64_t seed = 1;
  };

  class Endpoint final : public CanBus {
   public:
    Endpoint(SimBus& bus, std::size_t index) noexcept : bus_(bus), index_(index) {}

   private:
    Result<> do_send(const CanFrame& frame) noexcept override;
    Result<CanFrame> do_receive(std::chrono::nanoseconds timeout) noexcept override;
    Result<> do_purge() noexcept override;
    [[nodiscard]] BusHealth do_health() const noexcept override;

    SimBus& bus_;
    std::size_t index_;
  };

  SimBus(const Config& config, Clock& clock);
  SimBus(const SimBus&) = delete;
  SimBus& operator=(const SimBus&) = delete;

  /// One more participant; the reference stays valid as long as the bus.
  Endpoint& connect();
  void set_faults(const BusFaults& faults) noexcept;
  /// kBusOff and kDown end every send and receive of all endpoints, and drop what is queued.
  void set_state(BusState state) noexcept;
  [[nodiscard]] BusFaultCounts fault_counts() const noexcept;
  /// Time on the wire, with the worst stuffing.
  [[nodiscard]] std::int64_t wire_ns(const CanFrame& frame) const noexcept;

 private:
  struct Port {
    explicit Port(const Config& config) : slots(config.send_queue), to_send(slots) {
      inbox.reserve(config.receive_queue);
    }
    std::vector<SendQueue::Slot> slots;
    SendQueue to_send;
    std::vector<CanFrame> inbox;  ///< In the order of `stamp_ns`.
    BusHealth health;
  };

  [[nodiscard]] bool gone() const noexcept {
    return state_ == BusState::kBusOff || state_ == BusState::kDown;
  }
  void advance(std::int64_t now_ns) noexcept;
  bool transmit_next(std::int64_t now_ns) noexcept;
  void deliver(CanFrame frame, std::size_t from) noexcept;
  void put_in_inboxes(const CanFrame& frame, std::size_t from) noexcept;
  [[nodiscard]] bool happens(double probability, std::uint64_t& count) noexcept;
  void spoil(CanFrame& frame) noexcept;
  void flip_bits(CanFrame& frame) noexcept;
  void make_noise(CanFrame& frame) noexcept;

  Config config_;
  Clock& clock_;
  mutable std::mutex mutex_;
  std::deque<Endpoint> endpoints_;
  std::deque<Port> ports_;
  BusState state_ = BusState::kErrorActive;
  std::int64_t free_ns_ = 0;
  BusFaults faults_;
  BusFaultCounts counts_;
  CanFrame before_;
  Pcg32 random_;
};

}  // namespace dseam::hal::sim
