// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "dseam/base/lane_packer.hpp"
#include "dseam/base/lanes.hpp"
#include "dseam/search/voxel_hash.hpp"

namespace dseam::cloud {

/// Points on their way into the cells of a lattice, cut into runs that fell into one cell one after
/// the other: beside each other on a surface a scanner's points do.
///
/// Memory:  25 kB, lent.
class CellRuns {
 public:
  // Many, so that slots far apart in memory can be asked for ahead; a microcontroller has no cache
  // to ask for, and little memory.
#if defined(DSEAM_LANES_IN_REGISTERS)
  static constexpr std::size_t kCapacity = 512;
#else
  static constexpr std::size_t kCapacity = 64;
#endif

  /// One axis of eight points: which cell, and how far into it in steps of 2^-20 cells.
  struct Axis {
    lanes::IntLanes cell;
    lanes::IntLanes step;
  };

  [[nodiscard]] bool has_room() const noexcept { return size_ + lanes::kLanes <= kCapacity; }
  /// Those whose bit is set; mostly all are, which needs no packing.
  [[gnu::always_inline]] void append(const Axis& x, const Axis& y, const Axis& z,
                                     std::uint32_t valid) noexcept {
    if (valid == 0xFFU) {
      store(x, y, z,
            [](const lanes::IntLanes& from, std::uint32_t* to) { lanes::store(from, to); });
    } else {
      const lanes::LanePacker packer(valid);
      store(x, y, z,
            [&](const lanes::IntLanes& from, std::uint32_t* to) { packer.store(from, to); });
    }
    size_ += static_cast<std::size_t>(std::popcount(valid));
  }
  /// Finds the runs of what was appended; returns how many.
  [[nodiscard]] std::size_t cut() noexcept;
  void clear() noexcept { size_ = 0; }

  [[nodiscard]] search::CellKey key(std::size_t run) const noexcept {
    const std::uint32_t at = begin_[run] + 1;
    return search::CellKey::of(static_cast<std::int32_t>(x_.cell[at]),
                               static_cast<std::int32_t>(y_.cell[at]),
                               static_cast<std::int32_t>(z_.cell[at]));
  }
  [[nodiscard]] std::uint32_t count(std::size_t run) const noexcept {
    return begin_[run + 1] - begin_[run];
  }
  /// Sums of the steps of its points.
  [[nodiscard]] std::uint32_t x(std::size_t run) const noexcept { return sum(x_, run); }
  [[nodiscard]] std::uint32_t y(std::size_t run) const noexcept { return sum(y_, run); }
  [[nodiscard]] std::uint32_t z(std::size_t run) const noexcept { return sum(z_, run); }

  /// A run's cell and where it is looked for; for who looks.
  struct Wanted {
    search::CellKey key;
    search::VoxelHash::Place place;
  };
  Wanted wanted[kCapacity];

 private:
  static constexpr std::size_t kRoom = 1 + kCapacity + lanes::kLanes;
  // Place 0 lies before the first point. No sum overflows: 512 points have at most 2^29 steps.
  struct Points {
    std::uint32_t cell[kRoom];
    std::uint32_t steps[kRoom];
  };
  template <typename Store>
  [[gnu::always_inline]] void store(const Axis& x, const Axis& y, const Axis& z,
                                    const Store& store_at) noexcept {
    const std::size_t to = size_ + 1;
    store_at(x.cell, x_.cell + to);
    store_at(y.cell, y_.cell + to);
    store_at(z.cell, z_.cell + to);
    store_at(x.step, x_.steps + to);
    store_at(y.step, y_.steps + to);
    store_at(z.step, z_.steps + to);
  }
  void sum_up() noexcept;
  [[nodiscard]] std::uint32_t sum(const Points& axis, std::size_t run) const noexcept {
    return axis.steps[begin_[run + 1]] - axis.steps[begin_[run]];
  }

  Points x_, y_, z_;
  std::uint32_t begin_[kRoom];
  std::size_t size_ = 0;
};

}  // namespace dseam::cloud
