// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/cell_runs.hpp"

#include <algorithm>

namespace dseam::cloud {
namespace {

using lanes::IntLanes;
using lanes::kLanes;

constexpr std::uint32_t kNoCell = 0x80000000U;
constexpr std::uint32_t kAll = 0xFFU;

// Whether each of eight is where the one before is.
IntLanes is_same(const std::uint32_t* cell) noexcept {
  return lanes::load_lanes<IntLanes>(cell) == lanes::load_lanes<IntLanes>(cell - 1);
}

}  // namespace

void CellRuns::sum_up() noexcept {
  IntLanes x = lanes::splat(0);
  IntLanes y = x;
  IntLanes z = x;
  const auto add_eight = [](std::uint32_t* steps, const IntLanes& before) noexcept {
    const IntLanes sums = lanes::running_sum(lanes::load_lanes<IntLanes>(steps));
    lanes::store(before + sums, steps);
    return before + lanes::splat(static_cast<std::int32_t>(sums[kLanes - 1]));
  };
  x_.steps[0] = y_.steps[0] = z_.steps[0] = 0;
  for (Points* axis : {&x_, &y_, &z_}) {  // The last eight reach past the points, to no steps.
    std::fill_n(axis->steps + size_ + 1, kLanes - 1, 0U);
  }
  for (std::size_t i = 1; i <= size_; i += kLanes) {  // All three at once: each waits for its sum.
    x = add_eight(x_.steps + i, x);
    y = add_eight(y_.steps + i, y);
    z = add_eight(z_.steps + i, z);
  }
}

std::size_t CellRuns::cut() noexcept {
  constexpr std::int32_t kNumbers[kLanes] = {0, 1, 2, 3, 4, 5, 6, 7};
  sum_up();
  x_.cell[0] = kNoCell;
  std::size_t runs = 0;
  for (std::size_t i = 0; i < size_; i += kLanes) {
    const IntLanes same =
        is_same(x_.cell + i + 1) & is_same(y_.cell + i + 1) & is_same(z_.cell + i + 1);
    const std::uint32_t used = kAll >> (kLanes - std::min(kLanes, size_ - i));
    const std::uint32_t first = ~lanes::bits(same) & used;
    const IntLanes numbers = lanes::load(kNumbers) + lanes::splat(static_cast<std::int32_t>(i));
    lanes::LanePacker(first).store(numbers, begin_ + runs);
    runs += static_cast<std::size_t>(std::popcount(first));
  }
  begin_[runs] = static_cast<std::uint32_t>(size_);
  return runs;
}

}  // namespace dseam::cloud
