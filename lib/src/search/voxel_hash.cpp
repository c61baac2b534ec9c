// SPDX-License-Identifier: Apache-2.0
#include "dseam/search/voxel_hash.hpp"

#include <algorithm>

namespace dseam::search {
namespace {

constexpr std::size_t kMostCells = std::size_t{1} << 30U;

}  // namespace

Result<VoxelHash> VoxelHash::make(std::size_t max_cells, Arena& arena,
                                  std::uint64_t secret) noexcept {
  if (max_cells == 0 || max_cells > kMostCells) {
    return Errc::kInvalidArgument;
  }
  VoxelHash hash(max_cells, arena, mixed(secret, kDefaultSecret));
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return hash;
}

// Slots keep the numbers of before, which now mean nothing, until there would be too many.
void VoxelHash::clear() noexcept {
  cleared_ += size_;
  size_ = 0;
  if (cleared_ > kAbsent - 1 - keys_.size()) {
    std::fill(slots_.begin(), slots_.end(), Slot{});
    cleared_ = 0;
  }
}

std::uint32_t VoxelHash::search_or_insert(CellKey key, Place place) noexcept {
  std::size_t at = place.slot;
  for (std::uint32_t probe = 0; probe < kMaxProbes; at = next(at, probe++)) {
    Slot& slot = slots_[at];
    if (slot.number <= cleared_) {
      return insert(key, place.tag, slot);
    }
    const std::uint32_t number = slot.number - cleared_ - 1;
    if (slot.tag == place.tag && keys_[number] == key) {
      return number;
    }
  }
  return kFull;
}

std::uint32_t VoxelHash::find(CellKey key) const noexcept {
  const auto [first, tag] = place_of(key);
  std::size_t at = first;
  for (std::uint32_t probe = 0; probe < kMaxProbes; at = next(at, probe++)) {
    const Slot& slot = slots_[at];
    if (slot.number <= cleared_) {
      return kAbsent;
    }
    const std::uint32_t number = slot.number - cleared_ - 1;
    if (slot.tag == tag && keys_[number] == key) {
      return number;
    }
  }
  return kAbsent;
}

}  // namespace dseam::search
