// SPDX-License-Identifier: Apache-2.0
#include "support/shapes/clouds.hpp"

#include <array>
#include <bit>
#include <cmath>

namespace dseam::test {
namespace {

struct Point {
  float x;
  float y;
  float z;
};

// A whole number times a power of two is exact in float.
float fraction(Pcg32& random, std::uint32_t steps, float step_mm) {
  return static_cast<float>(random.below(steps)) * step_mm;
}
float within(Pcg32& random, float half_mm) {
  return (fraction(random, 65536, 0.000030517578125F) - 1.0F) * half_mm;
}

// As many points to the square millimetre whatever their number: 0.75 mm apart.
Point surface(Pcg32& random, std::size_t num_points) {
  const auto steps = static_cast<std::uint32_t>(96.0 * std::sqrt(static_cast<double>(num_points)));
  const float x = fraction(random, steps, 0.0078125F);
  const float y = fraction(random, steps, 0.0078125F);
  const float turns = x * 0.03125F;
  const float roof = std::fabs(turns - std::floor(turns) - 0.5F) * 24.0F;  // A ridge every 32 mm.
  return {x - 100.0F, y - 50.0F, roof + fraction(random, 64, 0.0009765625F)};
}

Point volume(Pcg32& random, std::size_t num_points) {
  const float half_mm = static_cast<float>(std::cbrt(static_cast<double>(num_points)) * 0.375);
  return {within(random, half_mm), within(random, half_mm), within(random, half_mm)};
}

Point lattice(Pcg32& random, std::size_t num_points) {
  const auto side = static_cast<std::uint32_t>(std::cbrt(static_cast<double>(num_points))) + 1;
  return {fraction(random, side, 1.0F) - 5.0F, fraction(random, side, 1.0F) - 5.0F,
          fraction(random, side, 1.0F) - 5.0F};
}

Point one_cell(Pcg32& random) {
  return {1000.0F + within(random, 0.05F), -500.0F + within(random, 0.05F), within(random, 0.05F)};
}

Point coplanar(Pcg32& random, std::size_t num_points) {
  Point p = surface(random, num_points);
  p.z = 12.5F;
  return p;
}

float beside_a_face(Pcg32& random, std::uint32_t side) {
  const auto face = static_cast<float>(1 + random.below(side));
  const std::uint32_t ulps = random.below(3);
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(face) + ulps - 1U);
}

Point cell_faces(Pcg32& random, std::size_t num_points) {
  const auto side = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(num_points))) + 1;
  return {beside_a_face(random, side), -beside_a_face(random, side), beside_a_face(random, 3)};
}

Point cluster(Pcg32& random) {
  static constexpr std::array<float, 5> kHalf = {1000.0F, 1.0F, 1.0e-3F, 1.0e-6F, 1.0e-9F};
  const float half_mm = kHalf[random.below(5)];
  return {within(random, half_mm), within(random, half_mm), within(random, half_mm)};
}

Point spoilt(Point p, std::size_t i) {
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
  switch (i % 9) {
    case 0:
      return {std::numeric_limits<float>::quiet_NaN(), p.y, p.z};
    case 3:
      return {p.x, kInfinity, p.z};
    case 6:
      return {p.x, p.y, -kInfinity};
    default:
      return p;
  }
}

Point next_point(Family family, Pcg32& random, std::size_t n, std::size_t i) {
  switch (family) {
    case Family::kSurface:
      return surface(random, n);
    case Family::kVolume:
      return volume(random, n);
    case Family::kLattice:
      return lattice(random, n);
    case Family::kIdentical:
      return {7.25F, -3.5F, 411.0F};
    case Family::kOneCell:
      return one_cell(random);
    case Family::kOneFarOutlier:
      return i == n / 2 ? Point{9.0e6F, 9.0e6F, 9.0e6F} : surface(random, n);
    case Family::kHalfOutliers:
      return i % 2 == 0
                 ? surface(random, n)
                 : Point{within(random, 5000.0F), within(random, 5000.0F), within(random, 5000.0F)};
    case Family::kCollinear: {
      const float t = fraction(random, 1U << 22U, 0.0009765625F);
      return {t, 2.0F * t, -0.5F * t};
    }
    case Family::kCoplanar:
      return coplanar(random, n);
    case Family::kCellFaces:
      return cell_faces(random, n);
    case Family::kClusters:
      return cluster(random);
    case Family::kNotFinite:
      return spoilt(surface(random, n), i);
    case Family::kDuplicates:
    case Family::kTwoPlanes:
      break;  // Made of others below.
  }
  return {};
}

void add(OwnedCloud& cloud, Point p) { cloud.add(p.x, p.y, p.z); }

}  // namespace

std::string_view name(Family family) {
  static constexpr std::array<std::string_view, kNumFamilies> kNames = {
      "surface",    "volume",          "lattice",       "identical", "duplicates",
      "one_cell",   "one_far_outlier", "half_outliers", "collinear", "coplanar",
      "two_planes", "cell_faces",      "clusters",      "not_finite"};
  return kNames[static_cast<std::size_t>(family)];
}

OwnedCloud make_cloud(Family family, std::size_t num_points, std::uint64_t seed) {
  Pcg32 random(seed, static_cast<std::uint64_t>(family));
  OwnedCloud cloud;
  while (cloud.size() < num_points) {
    const std::size_t i = cloud.size();
    if (family == Family::kDuplicates || family == Family::kTwoPlanes) {
      const bool first = i % (family == Family::kDuplicates ? 4U : 2U) == 0;
      add(cloud, !first ? Point{cloud.x.back(), cloud.y.back(), cloud.z.back()}
                 : family == Family::kDuplicates ? surface(random, num_points)
                                                 : coplanar(random, num_points));
    } else {
      add(cloud, next_point(family, random, num_points, i));
    }
  }
  return cloud;
}

}  // namespace dseam::test
