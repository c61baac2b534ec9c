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

// All three at once: each waits for its sum.
void CellRuns::sum_up() noexcept {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t z = 0;
  x_.steps[0] = y_.steps[0] = z_.steps[0] = 0;
  for (std::size_t i = 1; i <= size_; ++i) {
    x_.steps[i] = x += x_.steps[i];
    y_.steps[i] = y += y_.steps[i];
    z_.steps[i] = z += z_.steps[i];
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
