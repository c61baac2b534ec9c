// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/search/grid_index.hpp"

namespace dseam::cloud {

/// Removes points whose neighbours are unusually far away (statistical outlier removal).
///
/// A point's distance is the mean over its `num_neighbours` nearest others; it is kept when that is
/// at most mean + alpha * sigma of all points' distances. Points the index left out are not kept.
///
/// Memory:  4 bytes a point.
/// Time:    that of GridIndex::mean_distances(), linear also for identical points.
/// Context: real-time safe.
/// Source:  the paper's equations 2 to 5; sigma is over n, as in equation 4.
class OutlierRemoval {
 public:
  struct Config {
    std::uint32_t num_neighbours = 5;
    float alpha = 1.0F;
  };
  struct Report {
    std::uint32_t kept = 0;
    std::uint32_t removed = 0;
    std::uint32_t dropped_full = 0;  ///< To be kept, but `kept` was full.
    bool too_few_points = false;     ///< No more than num_neighbours: fewer were averaged.
    float mean_mm = 0.0F;
    float sigma_mm = 0.0F;
    float threshold_mm = 0.0F;
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_points) noexcept {
    return Arena::bytes<float>(max_points);
  }
  /// kInvalidArgument: num_neighbours not in [1, GridIndex::kMaxBatchNeighbours], an alpha that is
  /// not finite. kOutOfMemory: the arena is too small.
  [[nodiscard]] static Result<OutlierRemoval> make(const Config& config, std::size_t max_points,
                                                   Arena& arena) noexcept;

  /// The indices of what is kept, rising. `index` was built over `num_points` points, no more than
  /// max_points.
  Report run(const search::GridIndex& index, std::size_t num_points,
             Buffer<std::uint32_t>& kept) noexcept;

 private:
  OutlierRemoval(const Config& config, std::span<float> mean_mm) noexcept
      : config_(config), mean_mm_(mean_mm) {}
  Config config_;
  std::span<float> mean_mm_;
};

}  // namespace dseam::cloud
