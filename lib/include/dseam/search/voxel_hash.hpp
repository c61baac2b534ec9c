// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/result.hpp"

namespace dseam::search {

/// A cell of a cubic lattice as 3 x 21 bits.
struct CellKey {
  std::uint64_t bits = 0;

  static constexpr std::uint32_t kAxisBits = 21;     ///< Of each axis + kMaxAxis; x is lowest.
  static constexpr std::int32_t kMaxAxis = 1 << 20;  ///< Axes lie in [-kMaxAxis, kMaxAxis).
  /// The axes must be in range.
  [[nodiscard]] static constexpr CellKey of(std::int32_t x, std::int32_t y,
                                            std::int32_t z) noexcept {
    return {axis(x) | (axis(y) << 21U) | (axis(z) << 42U)};
  }
  [[nodiscard]] constexpr std::int32_t x() const noexcept { return value(0); }
  [[nodiscard]] constexpr std::int32_t y() const noexcept { return value(21); }
  [[nodiscard]] constexpr std::int32_t z() const noexcept { return value(42); }
  friend constexpr bool operator==(CellKey, CellKey) = default;

 private:
  [[nodiscard]] static constexpr std::uint64_t axis(std::int32_t value) noexcept {
    return static_cast<std::uint64_t>(value + kMaxAxis);
  }
  [[nodiscard]] constexpr std::int32_t value(std::uint32_t shift) const noexcept {
    return static_cast<std::int32_t>((bits >> shift) & 0x1FFFFFU) - kMaxAxis;
  }
};

/// Numbers lattice cells in the order in which they are first seen.
///
/// Open addressing over at least twice as many slots as cells, 2 x 2 x 2 neighbours in one line of
/// the cache. The caller's secret is mixed into every hash, so that crafted coordinates cannot pile
/// up in one place; the numbers do not depend on it.
///
/// Memory:  24 to 40 bytes a cell.
/// Time:    at most kMaxProbes slots an operation, expected under two.
/// Context: real-time safe; one thread at a time.
class VoxelHash {
 public:
  static constexpr std::uint32_t kFull = 0xFFFFFFFFU;
  static constexpr std::uint32_t kAbsent = 0xFFFFFFFFU;
  static constexpr std::uint32_t kMaxProbes = 256;
  static constexpr std::uint64_t kDefaultSecret = 0x9E3779B97F4A7C15ULL;

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_cells) noexcept {
    return Arena::bytes<Slot>(slots_of(max_cells)) + Arena::bytes<CellKey>(max_cells);
  }
  /// kInvalidArgument: no cell, or more than 2^30. kOutOfMemory: the arena is too small.
  [[nodiscard]] static Result<VoxelHash> make(std::size_t max_cells, Arena& arena,
                                              std::uint64_t secret = kDefaultSecret) noexcept;

  void clear() noexcept;
  /// The cell's number; a new cell gets the number size(). kFull when there is no room for it.
  [[nodiscard]] std::uint32_t find_or_insert(CellKey key) noexcept {
    return find_or_insert(key, place_of(key));
  }
  [[nodiscard]] std::uint32_t find(CellKey key) const noexcept;

  /// Where the search for a cell begins. Many cells are found sooner when first all places are
  /// asked for and fetched: their memory comes while others are computed.
  struct Place {
    std::uint32_t slot;
    std::uint32_t tag;
  };
  [[nodiscard]] Place place_of(CellKey key) const noexcept;
  void fetch(Place place) const noexcept { __builtin_prefetch(&slots_[place.slot]); }
  [[nodiscard]] std::uint32_t find_or_insert(CellKey key, Place place) noexcept {
    Slot& slot = slots_[place.slot];
    if (slot.number <= cleared_) {
      return insert(key, place.tag, slot);
    }
    const std::uint32_t number = slot.number - cleared_ - 1;
    const bool is_here = slot.tag == place.tag && keys_[number] == key;
    return is_here ? number : search_or_insert(key, place);
  }

  [[nodiscard]] std::span<const CellKey> keys() const noexcept { return keys_.first(size_); }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return keys_.size(); }

 private:
  static constexpr std::size_t kInLine = 8;
  // Half of the hash decides the slot, the other half is kept to spare most looks at the key.
  struct Slot {
    std::uint32_t number;  ///< Above `cleared_`, counted from there; else the slot is free.
    std::uint32_t tag;
  };

  /// Into a free slot.
  [[nodiscard]] std::uint32_t insert(CellKey key, std::uint32_t tag, Slot& slot) noexcept {
    if (size_ == keys_.size()) {
      return kFull;
    }
    keys_[size_] = key;
    slot = {cleared_ + ++size_, tag};
    return size_ - 1;
  }
  [[nodiscard]] std::uint32_t search_or_insert(CellKey key, Place place) noexcept;

  [[nodiscard]] static constexpr std::uint64_t mixed(std::uint64_t key,
                                                     std::uint64_t secret) noexcept {
    key = (key ^ secret) * 0xD6E8FEB86659FD93ULL;
    key ^= key >> 32U;
    key = (key + secret) * 0xD6E8FEB86659FD93ULL;
    return key ^ (key >> 32U);
  }
  [[nodiscard]] static constexpr std::size_t slots_of(std::size_t max_cells) noexcept {
    return std::bit_ceil(2 * max_cells < kInLine ? kInLine : 2 * max_cells);
  }
  VoxelHash(std::size_t max_cells, Arena& arena, std::uint64_t secret) noexcept
      : slots_(arena.take<Slot>(slots_of(max_cells))),
        keys_(arena.take<CellKey>(max_cells)),
        secret_(secret) {}
  /// The same place of the next line; once round all lines, the next place.
  [[nodiscard]] std::size_t next(std::size_t slot, std::uint32_t probe) const noexcept {
    const bool is_round = (probe + 1) % (slots_.size() / kInLine) == 0;
    return (slot + kInLine + (is_round ? 1U : 0U)) & (slots_.size() - 1);
  }

  std::span<Slot> slots_;
  std::span<CellKey> keys_;
  std::uint64_t secret_;
  std::uint32_t cleared_ = 0;  ///< Numbers given before the last clear().
  std::uint32_t size_ = 0;
};

// Two rounds of multiply and fold, each keyed: without the secret no set of colliding keys can be
// written down beforehand. The block of eight decides the line. Which of it is a cell's own is
// shifted about by the hash, so that cells which are all even, say, still use all slots; the next
// try is the same one of the next line, so that a full line pushes no other aside.
inline VoxelHash::Place VoxelHash::place_of(CellKey key) const noexcept {
  constexpr std::uint64_t kLowest = CellKey{1U | 1ULL << 21U | 1ULL << 42U}.bits;
  const std::uint64_t low = key.bits & kLowest;
  const std::uint64_t hash = mixed(key.bits ^ low, secret_);
  const std::uint64_t within = (low | low >> 20U | low >> 40U) % kInLine;
  return {static_cast<std::uint32_t>((hash ^ within) & (slots_.size() - 1)),
          static_cast<std::uint32_t>(hash >> 32U) ^ static_cast<std::uint32_t>(within)};
}

}  // namespace dseam::search
