// SPDX-License-Identifier: Apache-2.0
#include "dseam/markers/blob_finder.hpp"

#include <algorithm>
#include <utility>

#include "dseam/base/lanes.hpp"

namespace dseam::markers {
namespace {

using lanes::IntLanes;

constexpr std::uint32_t kLanes = lanes::kLanes;
constexpr std::uint32_t kAll = 0xFFU;

}  // namespace

Result<BlobFinder> BlobFinder::make(const Config& config, std::uint32_t width,
                                    Arena& arena) noexcept {
  if (width < 8 || width > 16384) {
    return Errc::kInvalidArgument;
  }
  BlobFinder finder;
  finder.config_ = config;
  finder.width_ = width;
  if (config.half_window_px == 0) {
    finder.config_.half_window_px = std::max<std::uint32_t>(4, width / 30);
  }
  finder.blobs_ = arena.take<Blob>(kMaxBlobs);
  finder.no_row_ = arena.take<std::uint8_t>(width);
  finder.column_sums_ = arena.take<std::uint32_t>(width + kLanes);
  finder.sums_before_ = arena.take<std::uint32_t>(width + 1 + kLanes);
  finder.runs_ = arena.take<Run>(width);
  finder.runs_above_ = arena.take<Run>(width);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return finder;
}

BlobFinder::Report BlobFinder::run(std::span<const std::uint8_t> gray) noexcept {
  Report report;
  num_blobs_ = 0;
  const auto height = static_cast<std::int32_t>(gray.size() / width_);
  const auto half = static_cast<std::int32_t>(config_.half_window_px);
  std::fill(column_sums_.begin(), column_sums_.end(), 0U);
  const auto row = [&](std::int32_t v) {
    const bool exists = v >= 0 && v < height;
    return exists ? gray.subspan(static_cast<std::size_t>(v) * width_, width_) : no_row_;
  };
  for (std::int32_t v = 0; v < std::min(half, height); ++v) {
    slide_window(row(v), no_row_);
  }
  std::size_t count_above = 0;
  for (std::int32_t v = 0; v < std::min<std::int32_t>(height, 65535); ++v) {
    slide_window(row(v + half), row(v - half - 1));
    const std::int32_t rows =
        std::min(v + half, height - 1) - std::max<std::int32_t>(v - half, 0) + 1;
    const std::size_t count = find_runs(row(v), static_cast<std::uint32_t>(rows));
    connect(count, count_above, static_cast<std::uint16_t>(v), report);
    std::swap(runs_, runs_above_);
    count_above = count;
  }
  report.blobs = static_cast<std::uint32_t>(num_blobs_);
  return report;
}

void BlobFinder::slide_window(std::span<const std::uint8_t> entering,
                              std::span<const std::uint8_t> leaving) noexcept {
  const std::uint32_t whole = width_ / kLanes * kLanes;
  for (std::uint32_t u = 0; u < whole; u += kLanes) {
    const IntLanes sums = lanes::load_lanes<IntLanes>(&column_sums_[u]);
    lanes::store(sums + lanes::widen(&entering[u]) - lanes::widen(&leaving[u]), &column_sums_[u]);
  }
  for (std::uint32_t u = whole; u < width_; ++u) {
    column_sums_[u] += entering[u];
    column_sums_[u] -= leaving[u];
  }
}

// sums_before_[u] of all columns left of u; they wrap around, their differences do not.
void BlobFinder::sum_columns() noexcept {
  IntLanes before = lanes::splat(0);
  for (std::uint32_t u = 0; u < width_; u += kLanes) {
    const IntLanes sums = lanes::running_sum(lanes::load_lanes<IntLanes>(&column_sums_[u]));
    lanes::store(before + sums, &sums_before_[u + 1]);
    before = before + lanes::splat(static_cast<std::int32_t>(sums[kLanes - 1]));
  }
}

// The mean is never formed: pixel < mean - contrast becomes (pixel + contrast) * n < sum.
std::int32_t BlobFinder::sign_at(std::span<const std::uint8_t> row, std::uint32_t u,
                                 std::uint32_t rows_in_window) const noexcept {
  const std::uint32_t half = config_.half_window_px;
  const std::uint32_t first = u > half ? u - half : 0;
  const std::uint32_t end = std::min(u + half + 1, width_);
  const auto n = static_cast<std::int32_t>((end - first) * rows_in_window);
  const auto sum = static_cast<std::int32_t>(sums_before_[end] - sums_before_[first]);
  const std::int32_t difference = row[u] * n - sum;
  const std::int32_t limit = config_.min_contrast * n;
  return (difference > limit ? 1 : 0) - (difference < -limit ? 1 : 0);
}

BlobFinder::Signs BlobFinder::eight_signs_at(std::span<const std::uint8_t> row, std::uint32_t u,
                                             std::uint32_t rows_in_window) const noexcept {
  const std::uint32_t half = config_.half_window_px;
  const IntLanes n = lanes::splat(static_cast<std::int32_t>((2 * half + 1) * rows_in_window));
  const IntLanes sum = lanes::load_lanes<IntLanes>(&sums_before_[u + half + 1]) -
                       lanes::load_lanes<IntLanes>(&sums_before_[u - half]);
  const IntLanes difference = lanes::widen(&row[u]) * n - sum;
  const IntLanes limit = lanes::splat(std::int32_t{config_.min_contrast}) * n;
  return {lanes::bits(limit < difference), lanes::bits(difference < lanes::splat(0) - limit)};
}

/// Joins the signs of a row's pixels, read from left to right, to runs.
struct BlobFinder::RunReader {
  std::span<Run> runs;
  std::size_t count = 0;
  std::int32_t open = 0;  // The sign of the run that is being read, 0 for none.

  void read(std::uint32_t u, std::int32_t sign) noexcept {
    if (sign == open) {
      return;
    }
    if (open != 0) {
      runs[count++].end = static_cast<std::uint16_t>(u);
    }
    if (sign != 0) {
      runs[count] = {static_cast<std::uint16_t>(u), 0,
                     sign > 0 ? Polarity::kLightOnDark : Polarity::kDarkOnLight, kNoBlob};
    }
    open = sign;
  }
  void read_eight(std::uint32_t u, Signs signs) noexcept {
    const Signs same{open > 0 ? kAll : 0U, open < 0 ? kAll : 0U};
    if (signs.light == same.light && signs.dark == same.dark) {
      return;
    }
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      read(u + i, static_cast<std::int32_t>(signs.light >> i & 1U) -
                      static_cast<std::int32_t>(signs.dark >> i & 1U));
    }
  }
};

std::size_t BlobFinder::find_runs(std::span<const std::uint8_t> row,
                                  std::uint32_t rows_in_window) noexcept {
  sum_columns();
  RunReader reader{runs_};
  const std::uint32_t half = config_.half_window_px;
  std::uint32_t u = 0;
  for (; u < std::min(half, width_); ++u) {
    reader.read(u, sign_at(row, u, rows_in_window));
  }
  for (; u + half + kLanes <= width_; u += kLanes) {
    reader.read_eight(u, eight_signs_at(row, u, rows_in_window));
  }
  for (; u < width_; ++u) {
    reader.read(u, sign_at(row, u, rows_in_window));
  }
  reader.read(width_, 0);
  return reader.count;
}

void BlobFinder::connect(std::size_t count, std::size_t count_above, std::uint16_t v,
                         Report& report) noexcept {
  std::size_t first_above = 0;
  for (std::size_t i = 0; i < count; ++i) {
    connect_run(runs_[i], count_above, first_above);
    extend(runs_[i], v, report);
  }
}

// Joins the run with those of its polarity in the row above that touch it, corners included.
void BlobFinder::connect_run(Run& run, std::size_t count_above, std::size_t& first_above) noexcept {
  while (first_above < count_above && runs_above_[first_above].end < run.begin) {
    ++first_above;
  }
  for (std::size_t k = first_above; k < count_above && runs_above_[k].begin <= run.end; ++k) {
    const Run& above = runs_above_[k];
    if (above.polarity != run.polarity || above.blob == kNoBlob) {
      continue;
    }
    run.blob = run.blob == kNoBlob ? root(above.blob) : merge(run.blob, root(above.blob));
  }
}

void BlobFinder::extend(Run& run, std::uint16_t v, Report& report) noexcept {
  if (run.blob == kNoBlob) {
    if (num_blobs_ == blobs_.size()) {
      ++report.lost;
      return;
    }
    run.blob = static_cast<std::uint32_t>(num_blobs_++);
    blobs_[run.blob] = {0, run.begin, run.end, v, v, run.polarity, run.blob, 0, 0, 0, 0, 0};
  }
  Blob& blob = blobs_[run.blob];
  const std::uint64_t n = static_cast<std::uint64_t>(run.end) - run.begin;
  const std::uint64_t first = run.begin;
  const std::uint64_t last = first + n - 1;
  const std::uint64_t sum_u = (first + last) * n / 2;
  const auto squares = [](std::uint64_t k) { return k * (k + 1) * (2 * k + 1) / 6; };
  blob.area_px += static_cast<std::uint32_t>(n);
  blob.min_u = std::min(blob.min_u, run.begin);
  blob.max_u = std::max(blob.max_u, static_cast<std::uint16_t>(last));
  blob.max_v = v;
  blob.sum_u += sum_u;
  blob.sum_v += n * v;
  blob.sum_uu += squares(last) - (first > 0 ? squares(first - 1) : 0);
  blob.sum_vv += n * v * v;
  blob.sum_uv += sum_u * v;
}

std::uint32_t BlobFinder::root(std::uint32_t blob) noexcept {
  while (blobs_[blob].parent != blob) {
    blobs_[blob].parent = blobs_[blobs_[blob].parent].parent;
    blob = blobs_[blob].parent;
  }
  return blob;
}

std::uint32_t BlobFinder::merge(std::uint32_t a, std::uint32_t b) noexcept {
  if (a == b) {
    return a;
  }
  Blob& keep = blobs_[std::min(a, b)];
  Blob& give = blobs_[std::max(a, b)];
  give.parent = keep.parent;
  keep.area_px += give.area_px;
  keep.min_u = std::min(keep.min_u, give.min_u);
  keep.max_u = std::max(keep.max_u, give.max_u);
  keep.min_v = std::min(keep.min_v, give.min_v);
  keep.max_v = std::max(keep.max_v, give.max_v);
  keep.sum_u += give.sum_u;
  keep.sum_v += give.sum_v;
  keep.sum_uu += give.sum_uu;
  keep.sum_vv += give.sum_vv;
  keep.sum_uv += give.sum_uv;
  return keep.parent;
}

}  // namespace dseam::markers
