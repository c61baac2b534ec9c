// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "dseam/hal/can_bus.hpp"
#include "dseam/hal/clock.hpp"

namespace dseam::hal::candump {

/// A CanBus that remembers every frame which passes through it, for can.log.
///
/// Memory:  two rings made at construction; a full one drops frames and counts them.
/// Context: as CanBus; flush() from one thread that may block.
class RecordingBus final : public CanBus {
 public:
  RecordingBus(CanBus& bus, Clock& clock, std::string interface, std::size_t capacity = 1U << 16U);

  /// Appends to `log`, in the order of time, what has passed since the last flush.
  ///
  /// Errors:  kIo: the file did not take it.
  Result<> flush(std::FILE* log);
  [[nodiscard]] std::uint64_t not_recorded() const noexcept { return not_recorded_.load(); }

 private:
  /// One writer, one reader.
  class Ring {
   public:
    explicit Ring(std::size_t capacity) : frames_(capacity) {}
    bool push(const CanFrame& frame) noexcept;
    /// The oldest frame, or nullptr.
    [[nodiscard]] const CanFrame* front() const noexcept;
    void pop() noexcept { read_.fetch_add(1, std::memory_order_release); }

   private:
    std::vector<CanFrame> frames_;
    std::atomic<std::size_t> written_{0};
    std::atomic<std::size_t> read_{0};
  };

  void record(Ring& ring, const CanFrame& frame) noexcept;
  Result<> do_send(const CanFrame& frame) noexcept override;
  Result<CanFrame> do_receive(std::chrono::nanoseconds timeout) noexcept override;
  Result<> do_purge() noexcept override { return bus_.purge(); }
  [[nodiscard]] BusHealth do_health() const noexcept override { return bus_.health(); }

  CanBus& bus_;
  Clock& clock_;
  std::string interface_;
  Ring sent_;
  Ring received_;
  std::atomic<std::uint64_t> not_recorded_{0};
};

}  // namespace dseam::hal::candump
