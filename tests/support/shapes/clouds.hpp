// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/cloud/cloud.hpp"

namespace dseam::test {

/// A cloud that owns its points.
struct OwnedCloud {
  std::vector<float> x;
  std::vector<float> y;
  std::vector<float> z;

  void add(float px, float py, float pz) {
    x.push_back(px);
    y.push_back(py);
    z.push_back(pz);
  }
  [[nodiscard]] std::size_t size() const { return x.size(); }
  [[nodiscard]] cloud::CloudView view() const { return {x, y, z}; }
};

/// The families of clouds on which filters and searches are judged. All coordinates come from whole
/// numbers, so that every platform sees the same bits.
enum class Family : std::uint8_t {
  kSurface,        ///< A folded sheet, seen as by a scanner: the nominal one.
  kVolume,         ///< Evenly in a cube: about one in each cell.
  kLattice,        ///< Whole millimetres, so that everything ties and lies on cell faces.
  kIdentical,      ///< One place.
  kDuplicates,     ///< Every place several times.
  kOneCell,        ///< All within a tenth of a millimetre, far from the origin.
  kOneFarOutlier,  ///< A surface and one point nine kilometres away.
  kHalfOutliers,   ///< Every other point anywhere in ten metres.
  kCollinear,
  kCoplanar,
  kTwoPlanes,  ///< Two coincident planes, point by point.
  kCellFaces,  ///< Within one ulp of the faces of millimetre cells.
  kClusters,   ///< Each a thousand times smaller than the one before.
  kNotFinite,  ///< A surface in which every third point has a NaN or an infinity.
};
inline constexpr int kNumFamilies = 14;

[[nodiscard]] std::string_view name(Family family);
[[nodiscard]] OwnedCloud make_cloud(Family family, std::size_t num_points, std::uint64_t seed);

}  // namespace dseam::test
