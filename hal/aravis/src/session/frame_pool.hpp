// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "dseam/base/result.hpp"

namespace dseam::hal::aravis {

/// The buffers that frames arrive in: one mapping, made before the first frame.
class FramePool {
 public:
  FramePool() = default;
  FramePool(const FramePool&) = delete;
  FramePool& operator=(const FramePool&) = delete;
  ~FramePool();

  Result<> map(std::uint32_t slots, std::size_t payload_bytes);
  [[nodiscard]] std::byte* slot(std::uint32_t index) const noexcept {
    return memory_ + index * slot_bytes_;
  }
  [[nodiscard]] std::uint32_t num_slots() const noexcept { return slots_; }
  [[nodiscard]] std::size_t payload_bytes() const noexcept { return payload_bytes_; }

 private:
  std::byte* memory_ = nullptr;
  std::size_t slot_bytes_ = 0;
  std::size_t payload_bytes_ = 0;
  std::uint32_t slots_ = 0;
};

}  // namespace dseam::hal::aravis
