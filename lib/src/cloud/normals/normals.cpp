// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/normals.hpp"

#include <algorithm>
#include <array>

#include "covariance_lanes.hpp"
#include "dseam/base/expects.hpp"
#include "dseam/geometry/symmetric_eigen3.hpp"
#include "orientation.hpp"

namespace dseam::cloud {
namespace {

using lanes::FloatLanes;
using lanes::kLanes;
using lanes::splat;

// Written so that NaN fails it.
bool is_ratio(float value) noexcept { return value >= 0.0F && value <= 1.0F; }

}  // namespace

Result<NormalEstimation> NormalEstimation::make(const Config& config) noexcept {
  const bool sensible = config.radius_mm > 0.0F && config.radius_mm <= search::GridIndex::kMaxMm &&
                        is_ratio(config.min_width_ratio) && is_ratio(config.min_gap_ratio);
  if (!sensible) {
    return Errc::kInvalidArgument;
  }
  return NormalEstimation(config);
}

// The normals of the eight points of a cell.
class NormalEstimation::OfCell {
 public:
  OfCell(const Config& config, const search::CellTree& tree, NormalsBuffer& out) noexcept
      : config_(config),
        tree_(tree),
        out_(out),
        squared_radius_(splat(config.radius_mm * config.radius_mm)) {}

  void start(std::uint32_t) noexcept { moments_ = CovarianceLanes(); }
  void add(const search::QueryCell& query, const search::NearView& points) noexcept {
    moments_.add(query, points, squared_radius_);
  }
  void finish(std::uint32_t at) noexcept {
    const search::Cell& own = tree_.cells()[at];
    const geometry::LeastAxisLanes fit = geometry::least_axis(moments_.covariance());
    const FloatLanes width = splat(config_.min_width_ratio * config_.min_width_ratio);
    const FloatLanes few =
        splat(static_cast<float>(std::max<std::uint32_t>(config_.min_neighbours, 3)));
    const std::uint32_t too_few = lanes::bits(moments_.count() < few);
    const std::uint32_t flat = lanes::bits(fit.most * width < fit.middle);
    const std::uint32_t clear =
        lanes::bits(splat(config_.min_gap_ratio) * fit.middle < fit.middle - fit.least);
    const FloatLanes sum = fit.least + fit.middle + fit.most;
    const FloatLanes variation = lanes::max(fit.least, splat(0.0F)) / sum;
    for (std::size_t i = 0; i < kLanes && own.index[i] != search::kNoPoint; ++i) {
      const NormalState state = (too_few >> i & 1U) != 0 ? NormalState::kTooFew
                                : (flat >> i & 1U) == 0  ? NormalState::kCollinear
                                : (clear >> i & 1U) == 0 ? NormalState::kAmbiguous
                                                         : NormalState::kGood;
      const bool is_good = state == NormalState::kGood;
      const geometry::Vec3f axis{fit.axis.x[i], fit.axis.y[i], fit.axis.z[i]};
      out_.set(own.index[i], is_good ? axis : geometry::Vec3f{},
               sum[i] > 0.0F ? variation[i] : 0.0F, state);
    }
  }

 private:
  const Config& config_;
  const search::CellTree& tree_;
  NormalsBuffer& out_;
  FloatLanes squared_radius_;
  CovarianceLanes moments_;
};

NormalEstimation::Report NormalEstimation::run(const search::GridIndex& index,
                                               const FusedCloudView& cloud,
                                               std::span<const geometry::Vec3f> sensors,
                                               NormalsBuffer& out) const noexcept {
  DSEAM_EXPECTS(cloud.points.size() <= out.capacity());
  if (index.size() < cloud.points.size()) {
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      out.set(i, {}, 0.0F, NormalState::kTooFew);
    }
  }
  OfCell of_cell(config_, index.tree(), out);
  index.for_each_cell(config_.radius_mm, of_cell);
  std::array<std::uint32_t, 4> count{};
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    ++count[static_cast<std::size_t>(out.state[i])];
  }
  return {count[0], count[1], count[2], count[3], orient(cloud, sensors, out)};
}

}  // namespace dseam::cloud
