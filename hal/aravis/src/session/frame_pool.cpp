// SPDX-License-Identifier: Apache-2.0
#include "session/frame_pool.hpp"

#include <sys/mman.h>

namespace dseam::hal::aravis {

FramePool::~FramePool() {
  if (memory_ != nullptr) {
    munmap(memory_, slot_bytes_ * slots_);
  }
}

Result<> FramePool::map(std::uint32_t slots, std::size_t payload_bytes) {
  constexpr std::size_t kPage = 4096;
  slots_ = slots;
  payload_bytes_ = payload_bytes;
  slot_bytes_ = (payload_bytes + kPage - 1) / kPage * kPage;
  void* memory = mmap(nullptr, slot_bytes_ * slots_, PROT_READ | PROT_WRITE,
                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
  if (memory == MAP_FAILED) {
    return Errc::kOutOfMemory;
  }
  memory_ = static_cast<std::byte*>(memory);
  return {};
}

}  // namespace dseam::hal::aravis
