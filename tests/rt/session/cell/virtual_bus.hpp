// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/hal/can_bus.hpp"

namespace dseam::test {

/// What a virtual bus does to its frames.
struct BusTrouble {
  double lose = 0.0;  ///< Share of frames.
  double corrupt = 0.0;
  double duplicate = 0.0;
  double reorder = 0.0;  ///< Overtaken by the next one of their kind.
  std::int64_t extra_delay_ns = 0;
  bool blocked = false;  ///< The host's queue takes nothing.
  bool purge_fails = false;
  bool cut = false;         ///< Nothing arrives on either side.
  std::uint32_t flood = 0;  ///< Foreign frames towards the host in each millisecond.
  hal::BusState state = hal::BusState::kErrorActive;
};

/// Two ends and a wire between them, under virtual time. The host's end is a hal::CanBus.
class VirtualBus final : public hal::CanBus {
 public:
  explicit VirtualBus(std::uint64_t seed) : random_(seed, 7) {}

  /// Moves what is due; call before either side reads. Twice in a moment is once.
  void advance(std::int64_t now_ns);
  void robot_send(const hal::CanFrame& frame);
  bool robot_receive(hal::CanFrame& frame);

  BusTrouble trouble;
  std::vector<hal::CanFrame> sent_this_cycle;  ///< By the host; cleared by the test.
  std::uint64_t injected = 0;                  ///< Frames that were tampered with.

 private:
  struct Flying {
    std::int64_t due_ns;
    hal::CanFrame frame;
  };
  Result<> do_send(const hal::CanFrame& frame) noexcept override;
  Result<hal::CanFrame> do_receive(std::chrono::nanoseconds timeout) noexcept override;
  Result<> do_purge() noexcept override;
  [[nodiscard]] hal::BusHealth do_health() const noexcept override;
  struct Way {
    std::deque<Flying> flying;
    std::optional<hal::CanFrame> held;  ///< Waits to be overtaken.
    std::deque<hal::CanFrame> arrived;
  };
  void fly(hal::CanFrame frame, Way& way);
  bool happens(double share) { return share > 0.0 && random_.uniform() < share; }

  Pcg32 random_;
  std::int64_t now_ns_ = 0;
  std::uint64_t overflow_ = 0;
  Way to_robot_;
  Way to_host_;
};

}  // namespace dseam::test
