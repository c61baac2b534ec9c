// SPDX-License-Identifier: Apache-2.0
// Runs each stage of the core once over each family of clouds, every pair in a function of its own,
// so that callgrind can say how many instructions it took; check_effort.py does that and judges.
#include <algorithm>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include "dseam/cloud/normals.hpp"
#include "dseam/cloud/outlier_removal.hpp"
#include "dseam/cloud/radius_outlier_removal.hpp"
#include "dseam/cloud/voxel_downsample.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/clouds.hpp"

namespace dseam::test {
namespace {

constexpr std::size_t kPoints = 20000;
constexpr int kSorted = kNumFamilies;  // These three are the nominal surface in another order.
constexpr int kReversed = kNumFamilies + 1;
constexpr int kShuffled = kNumFamilies + 2;
constexpr int kCrafted = kNumFamilies + 3;  // Cells whose numbers differ in few and high bits.
constexpr int kNumClouds = kNumFamilies + 4;

std::string name_of(int number) {
  constexpr const char* kOthers[] = {"sorted", "reversed", "shuffled", "crafted_keys"};
  return number < kNumFamilies ? std::string(name(static_cast<Family>(number)))
                               : kOthers[number - kNumFamilies];
}

OwnedCloud crafted_cloud() {
  OwnedCloud cloud;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const auto axis = [](std::size_t number) { return 3072.0F * static_cast<float>(number); };
    cloud.add(axis(i % 28), axis(i / 28 % 28), axis(i / 784));
  }
  return cloud;
}

OwnedCloud in_order(const OwnedCloud& cloud, int order) {
  std::vector<std::size_t> places(cloud.size());
  std::iota(places.begin(), places.end(), 0U);
  std::sort(places.begin(), places.end(),
            [&](std::size_t a, std::size_t b) { return cloud.x[a] < cloud.x[b]; });
  if (order == kReversed) {
    std::reverse(places.begin(), places.end());
  }
  Pcg32 random(9);
  for (std::size_t i = places.size(); order == kShuffled && i > 1; --i) {
    std::swap(places[i - 1], places[random.below(static_cast<std::uint32_t>(i))]);
  }
  OwnedCloud ordered;
  for (const std::size_t place : places) {
    ordered.add(cloud.x[place], cloud.y[place], cloud.z[place]);
  }
  return ordered;
}

OwnedCloud cloud_of(int number) {
  if (number == kCrafted) {
    return crafted_cloud();
  }
  return number < kNumFamilies ? make_cloud(static_cast<Family>(number), kPoints, 1)
                               : in_order(make_cloud(Family::kSurface, kPoints, 1), number);
}

struct Core {
  ArenaOwner memory{2 * search::GridIndex::bytes(kPoints) + cloud::OutlierRemoval::bytes(kPoints) +
                    cloud::RadiusOutlierRemoval::bytes(kPoints) +
                    cloud::VoxelDownsample::bytes(kPoints) + cloud::CloudBuffer::bytes(kPoints) +
                    cloud::NormalsBuffer::bytes(kPoints)};
  search::GridIndex index = search::GridIndex::make(kPoints, memory.arena()).value();
  cloud::OutlierRemoval outliers = cloud::OutlierRemoval::make({}, kPoints, memory.arena()).value();
  cloud::RadiusOutlierRemoval lonely =
      cloud::RadiusOutlierRemoval::make({}, kPoints, memory.arena()).value();
  cloud::VoxelDownsample voxels = cloud::VoxelDownsample::make({}, kPoints, memory.arena()).value();
  cloud::NormalEstimation normals = cloud::NormalEstimation::make({.radius_mm = 7.5F}).value();
  cloud::CloudBuffer cells{kPoints, memory.arena()};
  cloud::NormalsBuffer normal_buffer{kPoints, memory.arena()};
  std::vector<std::uint32_t> storage = std::vector<std::uint32_t>(kPoints);
  std::vector<search::Neighbour> rows = std::vector<search::Neighbour>(5 * kPoints);
  Buffer<std::uint32_t> kept{storage};
};

// The names are read by the script.
template <int kCloud>
[[gnu::noinline]] void effort_outliers(Core& core, const OwnedCloud& cloud) {
  core.index.rebuild(cloud.view());
  core.outliers.run(core.index, cloud.size(), core.kept);
}
template <int kCloud>
[[gnu::noinline]] void effort_lonely(Core& core, const OwnedCloud& cloud) {
  core.index.rebuild(cloud.view());
  core.lonely.run(core.index, cloud.size(), core.kept);
}
template <int kCloud>
[[gnu::noinline]] void effort_voxels(Core& core, const OwnedCloud& cloud) {
  core.voxels.run(cloud.view(), core.cells);
}
template <int kCloud>
[[gnu::noinline]] void effort_normals(Core& core) {
  core.index.rebuild(core.cells.view());
  core.normals.run(core.index, {core.cells.view(), {}, {}}, {}, core.normal_buffer);
}
template <int kCloud>
[[gnu::noinline]] void effort_nearest(Core& core, const OwnedCloud& cloud) {
  core.index.rebuild(cloud.view());
  core.index.k_nearest_of_all(5, core.rows);
}

template <int kCloud>
void run_one(Core& core) {
  const OwnedCloud cloud = cloud_of(kCloud);
  effort_outliers<kCloud>(core, cloud);
  effort_lonely<kCloud>(core, cloud);
  effort_voxels<kCloud>(core, cloud);
  effort_normals<kCloud>(core);
  effort_nearest<kCloud>(core, cloud);
  std::printf("%d %s %zu\n", kCloud, name_of(kCloud).c_str(), core.cells.size());
}

template <int... kClouds>
void run_all(std::integer_sequence<int, kClouds...>) {
  Core core;
  (run_one<kClouds>(core), ...);
}

}  // namespace
}  // namespace dseam::test

int main() {
  dseam::test::run_all(std::make_integer_sequence<int, dseam::test::kNumClouds>{});
  return 0;
}
