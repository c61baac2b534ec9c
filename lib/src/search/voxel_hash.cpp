// SPDX-License-Identifier: Apache-2.0
#include "dseam/search/voxel_hash.hpp"

#include <algorithm>

namespace dseam::search {
namespace {

constexpr std::size_t kMostCells = std::size_t{1} << 30U;

// Two rounds of multiply and fold, each keyed: without the secret no set of colliding keys can be
// written down beforehand.
constexpr std::uint64_t mixed(std::uint64_t key, std::uint64_t secret) noexcept {
  key = (key ^ secret) * 0xD6E8FEB86659FD93ULL;
  key ^= key >> 32U;
  key = (key + secret) * 0xD6E8FEB86659FD93ULL;
  return key ^ (key >> 32U);
}

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

void VoxelHash::clear() noexcept {
  std::fill(slots_.begin(), slots_.end(), Slot{});
  size_ = 0;
}

// The block of eight decides the line. Which of it is a cell's own is shifted about by the hash, so
// that cells which are all even, say, still use all slots; the next try is the same one of the next
// line, so that a full line pushes no other aside.
VoxelHash::Place VoxelHash::place_of(CellKey key) const noexcept {
  constexpr std::uint64_t kLowest = CellKey{1U | 1ULL << 21U | 1ULL << 42U}.bits;
  const std::uint64_t low = key.bits & kLowest;
  const std::uint64_t hash = mixed(key.bits ^ low, secret_);
  const std::uint64_t within = (low | low >> 20U | low >> 40U) % kInLine;
  return {static_cast<std::size_t>(hash ^ within) & (slots_.size() - 1),
          static_cast<std::uint32_t>(hash >> 32U) ^ static_cast<std::uint32_t>(within)};
}

std::uint32_t VoxelHash::find_or_insert(CellKey key) noexcept {
  const auto [first, tag] = place_of(key);
  std::size_t at = first;
  for (std::uint32_t probe = 0; probe < kMaxProbes; at = next(at, probe++)) {
    Slot& slot = slots_[at];
    if (slot.number_plus_one == 0) {
      if (size_ == keys_.size()) {
        return kFull;
      }
      keys_[size_] = key;
      slot = {static_cast<std::uint32_t>(++size_), tag};
      return slot.number_plus_one - 1;
    }
    if (slot.tag == tag && keys_[slot.number_plus_one - 1] == key) {
      return slot.number_plus_one - 1;
    }
  }
  return kFull;
}

std::uint32_t VoxelHash::find(CellKey key) const noexcept {
  const auto [first, tag] = place_of(key);
  std::size_t at = first;
  for (std::uint32_t probe = 0; probe < kMaxProbes; at = next(at, probe++)) {
    const Slot& slot = slots_[at];
    if (slot.number_plus_one == 0) {
      return kAbsent;
    }
    if (slot.tag == tag && keys_[slot.number_plus_one - 1] == key) {
      return slot.number_plus_one - 1;
    }
  }
  return kAbsent;
}

}  // namespace dseam::search
