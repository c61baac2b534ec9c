// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/search/grid_index.hpp"

namespace dseam::cloud {

/// Keeps the points that have at least so many others within a radius.
///
/// Memory:  1 byte a point.
/// Time:    counting stops at `min_neighbours`, so that crowded points are the cheap ones.
/// Context: real-time safe.
class RadiusOutlierRemoval {
 public:
  struct Config {
    float radius_mm = 3.0F;
    std::uint32_t min_neighbours = 4;
  };
  struct Report {
    std::uint32_t kept = 0;
    std::uint32_t removed = 0;
    std::uint32_t dropped_full = 0;  ///< To be kept, but `kept` was full.
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_points) noexcept {
    return Arena::bytes<std::uint8_t>(max_points);
  }
  /// kInvalidArgument: a radius that is not positive and finite, or min_neighbours over 2^20.
  [[nodiscard]] static Result<RadiusOutlierRemoval> make(const Config& config,
                                                         std::size_t max_points,
                                                         Arena& arena) noexcept;

  /// The indices of what is kept, rising. `index` was built over `num_points` points, no more than
  /// max_points.
  Report run(const search::GridIndex& index, std::size_t num_points,
             Buffer<std::uint32_t>& kept) noexcept;

 private:
  RadiusOutlierRemoval(const Config& config, std::span<std::uint8_t> keep) noexcept
      : config_(config), keep_(keep) {}
  void judge_cell(const search::CellTree& tree, std::uint32_t at) noexcept;

  Config config_;
  std::span<std::uint8_t> keep_;
};

}  // namespace dseam::cloud
