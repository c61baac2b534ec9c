// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/lanes.hpp"
#include "dseam/base/result.hpp"
#include "dseam/markers/marker.hpp"

namespace dseam::markers {

/// A connected patch of pixels that are darker, or lighter, than the mean around them.
struct Blob {
  std::uint32_t area_px = 0;
  std::uint16_t min_u = 0;
  std::uint16_t max_u = 0;
  std::uint16_t min_v = 0;
  std::uint16_t max_v = 0;
  Polarity polarity = Polarity::kDarkOnLight;
  std::uint32_t parent = 0;  ///< Union-find, while the image is read.
  std::uint64_t sum_u = 0;
  std::uint64_t sum_v = 0;
  std::uint64_t sum_uu = 0;
  std::uint64_t sum_vv = 0;
  std::uint64_t sum_uv = 0;
};

/// Connected patches by an adaptive threshold, in one pass over the rows: run lengths, union-find.
///
/// Memory:  O(width) and `kMaxBlobs`, from the arena.
/// Time:    O(pixels).
class BlobFinder {
 public:
  static constexpr std::size_t kMaxBlobs = 32768;

  struct Config {
    std::uint32_t half_window_px = 0;  ///< Of the mean; 0: a thirtieth of the width.
    std::uint8_t min_contrast = 10;    ///< Against that mean.
  };
  struct Report {
    std::uint32_t blobs = 0;
    std::uint32_t lost = 0;  ///< Runs that found no free blob.
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::uint32_t width) noexcept {
    return Arena::bytes<Blob>(kMaxBlobs) + Arena::bytes<std::uint8_t>(width) +
           Arena::bytes<std::uint32_t>(width + lanes::kLanes) +
           Arena::bytes<std::uint32_t>(width + 1 + lanes::kLanes) + 2 * Arena::bytes<Run>(width);
  }
  /// Errors:  kInvalidArgument, kOutOfMemory.
  [[nodiscard]] static Result<BlobFinder> make(const Config& config, std::uint32_t width,
                                               Arena& arena) noexcept;

  /// Shape:   `gray` has width x height values row by row.
  Report run(std::span<const std::uint8_t> gray) noexcept;
  /// Those of the last run; merged ones have a `parent` other than themselves.
  [[nodiscard]] std::span<const Blob> blobs() const noexcept { return blobs_.first(num_blobs_); }

 private:
  struct Run {
    std::uint16_t begin = 0;
    std::uint16_t end = 0;
    Polarity polarity = Polarity::kDarkOnLight;
    std::uint32_t blob = 0;
  };
  static constexpr std::uint32_t kNoBlob = 0xFFFFFFFFU;

  BlobFinder() = default;
  /// Of eight pixels, a bit each: lighter, or darker, than the mean around them.
  struct Signs {
    std::uint32_t light;
    std::uint32_t dark;
  };
  struct RunReader;
  void slide_window(std::span<const std::uint8_t> entering,
                    std::span<const std::uint8_t> leaving) noexcept;
  void sum_columns() noexcept;
  [[nodiscard]] std::int32_t sign_at(std::span<const std::uint8_t> row, std::uint32_t u,
                                     std::uint32_t rows_in_window) const noexcept;
  [[nodiscard]] Signs eight_signs_at(std::span<const std::uint8_t> row, std::uint32_t u,
                                     std::uint32_t rows_in_window) const noexcept;
  std::size_t find_runs(std::span<const std::uint8_t> row, std::uint32_t rows_in_window) noexcept;
  void connect(std::size_t count, std::size_t count_above, std::uint16_t v,
               Report& report) noexcept;
  void connect_run(Run& run, std::size_t count_above, std::size_t& first_above) noexcept;
  void extend(Run& run, std::uint16_t v, Report& report) noexcept;
  std::uint32_t root(std::uint32_t blob) noexcept;
  std::uint32_t merge(std::uint32_t a, std::uint32_t b) noexcept;

  Config config_;
  std::uint32_t width_ = 0;
  std::span<Blob> blobs_;
  std::size_t num_blobs_ = 0;
  std::span<std::uint8_t> no_row_;  ///< Of zeros.
  std::span<std::uint32_t> column_sums_;
  std::span<std::uint32_t> sums_before_;
  std::span<Run> runs_;
  std::span<Run> runs_above_;
};

}  // namespace dseam::markers
