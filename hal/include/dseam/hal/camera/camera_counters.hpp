// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "dseam/hal/depth_camera.hpp"

namespace dseam::hal {

/// A backend's own CameraHealth: counted in one thread, read in another.
struct CameraCounters {
  using Counter = std::atomic<std::uint64_t>;

  Counter delivered{0};
  Counter skipped{0};
  Counter lost{0};
  Counter damaged{0};
  Counter underruns{0};
  Counter reconnects{0};

  [[nodiscard]] CameraHealth snapshot() const noexcept {
    return {.delivered = delivered.load(std::memory_order_relaxed),
            .skipped = skipped.load(std::memory_order_relaxed),
            .lost = lost.load(std::memory_order_relaxed),
            .damaged = damaged.load(std::memory_order_relaxed),
            .underruns = underruns.load(std::memory_order_relaxed),
            .reconnects = reconnects.load(std::memory_order_relaxed)};
  }
};

}  // namespace dseam::hal
