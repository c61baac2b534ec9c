// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/surface_patches.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dseam::splice {
namespace {

using Vector6f = Eigen::Matrix<float, 6, 1>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr std::uint32_t kBlock = PatchField::kBlockPx;
constexpr float kHalf = (kBlock - 1) / 2.0F;
constexpr float kScale = kBlock / 2.0F;

// The rows of the quadratic, the same in every block.
using Rows = std::array<std::array<float, 6>, std::size_t{kBlock} * kBlock>;

constexpr Rows make_rows() noexcept {
  Rows rows{};
  for (std::uint32_t j = 0; j < kBlock; ++j) {
    for (std::uint32_t i = 0; i < kBlock; ++i) {
      const float x = (static_cast<float>(i) - kHalf) / kScale;
      const float y = (static_cast<float>(j) - kHalf) / kScale;
      rows[std::size_t{j} * kBlock + i] = {1.0F, x, y, x * x, x * y, y * y};
    }
  }
  return rows;
}

constexpr Rows kRows = make_rows();

Eigen::Map<const Vector6f> row_of(std::size_t pixel) noexcept {
  return Eigen::Map<const Vector6f>(kRows[pixel].data());
}

// The normal matrix of a block without missing pixels; what is missing is taken off.
Matrix6d full_block() noexcept {
  Matrix6d full = Matrix6d::Zero();
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    full += (row_of(k) * row_of(k).transpose()).cast<double>();
  }
  return full;
}

struct Block {
  std::array<float, std::size_t{kBlock} * kBlock> z;  // Less `pivot`; unused where !used.
  std::array<bool, std::size_t{kBlock} * kBlock> used;
  float pivot = 0.0F;
  std::uint32_t count = 0;
};

void load(const depth::DepthImage& frame, std::uint32_t column, std::uint32_t row,
          Block& block) noexcept {
  block.count = 0;
  block.pivot = 0.0F;
  for (std::uint32_t j = 0; j < kBlock; ++j) {
    for (std::uint32_t i = 0; i < kBlock; ++i) {
      const std::uint16_t c = frame.count_at(column * kBlock + i, row * kBlock + j);
      const std::size_t k = std::size_t{j} * kBlock + i;
      const float z = static_cast<float>(c * frame.mm_per_count);
      block.used[k] = c > 0;
      block.pivot = block.count == 0 && c > 0 ? z : block.pivot;
      block.z[k] = z - block.pivot;
      block.count += c > 0 ? 1U : 0U;
    }
  }
}

void fit(const Matrix6d& full, const Block& block, SurfacePatch& patch) noexcept {
  Vector6f sum = Vector6f::Zero();
  Matrix6d normal = full;
  for (std::size_t k = 0; k < block.z.size(); ++k) {
    if (block.used[k]) {
      sum += block.z[k] * row_of(k);
    } else {
      normal -= (row_of(k) * row_of(k).transpose()).cast<double>();
    }
  }
  Eigen::Map<Vector6f>(patch.q.data()) = normal.llt().solve(sum.cast<double>()).cast<float>();
}

float residual(const Block& block, const SurfacePatch& patch, std::size_t k) noexcept {
  return block.z[k] - Eigen::Map<const Vector6f>(patch.q.data()).dot(row_of(k));
}

void measure(const Block& block, SurfacePatch& patch) noexcept {
  float squares = 0.0F;
  for (std::size_t k = 0; k < block.z.size(); ++k) {
    const float r = block.used[k] ? residual(block, patch, k) : 0.0F;
    squares += r * r;
  }
  patch.rms_mm = std::sqrt(squares / static_cast<float>(std::max<std::uint32_t>(block.count, 1)));
}

void drop_outliers(const SurfacePatch& patch, float gate_mm, Block& block) noexcept {
  for (std::size_t k = 0; k < block.z.size(); ++k) {
    if (block.used[k] && std::abs(residual(block, patch, k)) > gate_mm) {
      block.used[k] = false;
      --block.count;
    }
  }
}

// Up to two rounds of dropping what lies far off: a few flying pixels must not cost the block.
bool fit_robust(const Matrix6d& full, std::uint32_t min_count, Block& block,
                SurfacePatch& patch) noexcept {
  for (int round = 0; round < 3; ++round) {
    if (block.count < min_count) {
      return false;
    }
    fit(full, block, patch);
    measure(block, patch);
    const std::uint32_t before = block.count;
    drop_outliers(patch, std::max(3.5F * patch.rms_mm, 0.02F), block);
    if (block.count == before) {
      break;
    }
  }
  patch.q[0] += block.pivot;
  patch.num_pixels = static_cast<std::uint16_t>(block.count);
  return std::isfinite(patch.q[0]) && patch.q[0] > 0.0F;
}

bool is_hidden(std::span<const geometry::Ellipse> hidden, double u, double v,
               double margin) noexcept {
  return std::any_of(hidden.begin(), hidden.end(), [&](const geometry::Ellipse& e) {
    const double reach = margin * e.a + 0.75 * kBlock;
    return std::hypot(u - e.u, v - e.v) < reach;
  });
}

// The rms below which half of the smooth patches lie, to a twentieth of a micrometre's bin.
double median_rms(std::span<const SurfacePatch> patches, double max_rms_mm) noexcept {
  std::array<std::uint32_t, 500> bins{};
  const double per_mm = static_cast<double>(bins.size()) / max_rms_mm;
  std::uint32_t total = 0;
  for (const SurfacePatch& p : patches) {
    if (p.num_pixels > 0) {
      const double bin = static_cast<double>(p.rms_mm) * per_mm;
      ++bins[std::min(static_cast<std::size_t>(bin), bins.size() - 1)];
      ++total;
    }
  }
  std::uint32_t below = 0;
  std::size_t bin = 0;
  while (bin + 1 < bins.size() && 2 * (below + bins[bin]) < total) {
    below += bins[bin++];
  }
  return (static_cast<double>(bin) + 0.5) / per_mm;
}

}  // namespace

const SurfacePatch* PatchField::at(double u, double v) const noexcept {
  if (!(u > -0.5) || !(v > -0.5)) {
    return nullptr;
  }
  const double column = (u + 0.5) / kBlockPx;
  const double row = (v + 0.5) / kBlockPx;
  if (column >= columns || row >= rows) {
    return nullptr;
  }
  const std::size_t i =
      std::size_t{static_cast<std::uint32_t>(row)} * columns + static_cast<std::uint32_t>(column);
  return patches[i].num_pixels > 0 ? &patches[i] : nullptr;
}

SurfacePoint surface_at(const PatchField& field, double u, double v) noexcept {
  const SurfacePatch* patch = field.at(u, v);
  if (patch == nullptr) {
    return {};
  }
  const auto block_of = [](double pixel) { return std::floor((pixel + 0.5) / kBlock) * kBlock; };
  const double x = (u - block_of(u) - static_cast<double>(kHalf)) / static_cast<double>(kScale);
  const double y = (v - block_of(v) - static_cast<double>(kHalf)) / static_cast<double>(kScale);
  const Vector6d q = Eigen::Map<const Vector6f>(patch->q.data()).cast<double>();
  const double z = q(0) + q(1) * x + q(2) * y + q(3) * x * x + q(4) * x * y + q(5) * y * y;
  const double zu = (q(1) + 2.0 * q(3) * x + q(4) * y) / static_cast<double>(kScale);
  const double zv = (q(2) + q(4) * x + 2.0 * q(5) * y) / static_cast<double>(kScale);
  const depth::Intrinsics& k = field.intrinsics;
  const Eigen::Vector3d ray((u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0);
  const Eigen::Vector3d du = ray * zu + Eigen::Vector3d(z / k.fx, 0.0, 0.0);
  const Eigen::Vector3d dv = ray * zv + Eigen::Vector3d(0.0, z / k.fy, 0.0);
  return {true, ray * z, dv.cross(du).normalized()};
}

PatchExtractor::Report PatchExtractor::run(const depth::DepthImage& frame,
                                           std::span<const geometry::Ellipse> hidden,
                                           std::span<SurfacePatch> out) const noexcept {
  Report report;
  const depth::Intrinsics& k = frame.intrinsics;
  const std::size_t blocks = PatchField::size_for(k.width, k.height);
  if (out.size() < blocks || frame.depth.size() != std::size_t{k.width} * k.height) {
    return report;
  }
  report.blocks = static_cast<std::uint32_t>(blocks);
  const PatchField field{k, k.width / kBlock, k.height / kBlock, out.first(blocks)};
  const Matrix6d full = full_block();
  const auto min_count = static_cast<std::uint32_t>(config_.min_filled * kBlock * kBlock);
  for (std::uint32_t row = 0; row < field.rows; ++row) {
    for (std::uint32_t column = 0; column < field.columns; ++column) {
      SurfacePatch& patch = out[std::size_t{row} * field.columns + column];
      patch = {};
      const Eigen::Vector2d c = field.centre_px(column, row);
      Block block;
      load(frame, column, row, block);
      if (is_hidden(hidden, c.x(), c.y(), config_.ellipse_margin) ||
          !fit_robust(full, min_count, block, patch)) {
        patch = {};
        continue;
      }
      const SurfacePoint s = surface_at(field, c.x(), c.y());
      const double facing = -s.n_camera.dot(s.p_camera.normalized());
      const bool smooth = static_cast<double>(patch.rms_mm) <= config_.max_rms_mm;
      patch.num_pixels = smooth && facing >= config_.min_facing ? patch.num_pixels : 0;
    }
  }
  report.median_rms_mm = median_rms(out.first(blocks), config_.max_rms_mm);
  for (SurfacePatch& patch : out.first(blocks)) {
    const double limit = config_.max_rms_to_median * report.median_rms_mm;
    patch.num_pixels = static_cast<double>(patch.rms_mm) <= limit ? patch.num_pixels : 0;
    report.smooth += patch.num_pixels > 0 ? 1U : 0U;
  }
  return report;
}

}  // namespace dseam::splice
