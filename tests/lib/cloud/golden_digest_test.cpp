// SPDX-License-Identifier: Apache-2.0
// The same bits from every compiler, optimisation and processor: this file holds the digests that
// all of them must give.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "dseam/cloud/crop_box.hpp"
#include "dseam/cloud/frame_fuser.hpp"
#include "dseam/cloud/organized_normals.hpp"
#include "dseam/cloud/voxel_map.hpp"
#include "dseam/depth/unproject.hpp"
#include "stage_digest.hpp"

namespace dseam::cloud {
namespace {

using test::Family;

/// What digest_of() leaves out: the open side of the boundary, the crop box and the voxel map.
std::uint64_t digest_of_the_rest(const test::OwnedCloud& cloud) {
  const std::size_t n = cloud.size();
  test::ArenaOwner memory(search::GridIndex::bytes(n) + VoxelMap::bytes(n) +
                          NormalsBuffer::bytes(n) + seam::BoundaryBuffer::bytes(n) +
                          seam::BoundaryTest::bytes());
  Arena& arena = memory.arena();
  std::vector<std::uint32_t> storage(n);
  Buffer<std::uint32_t> list(storage);
  Digest digest;
  OrientedBox box;
  box.T_box_cloud = {
      {0.6F, 0.8F, 0.0F}, {-0.8F, 0.6F, 0.0F}, {0.0F, 0.0F, 1.0F}, {1.5F, 0.0F, 0.0F}};
  box.low_mm = {-20.0F, -30.0F, -40.0F};
  box.high_mm = {25.0F, 35.0F, 45.0F};
  CropBox::make({box}).value().run(cloud.view(), list);
  digest.add(list.view());
  auto map = VoxelMap::make({.cell_mm = 1.7F, .origin_mm = {0.3F, 0.1F, 0.2F}}, n, arena).value();
  map.insert(cloud.view(), 3);
  map.insert(cloud.view(), 9);
  const FusedCloudView fused = map.view();
  digest.add(fused.points);
  digest.add(fused.count);
  digest.add(fused.seen_by);
  auto index = search::GridIndex::make(n, arena).value();
  NormalsBuffer normals(n, arena);
  seam::BoundaryBuffer boundary(n, arena);
  index.rebuild(fused.points);
  NormalEstimation::make({.radius_mm = 4.0F}).value().run(index, fused, {}, normals);
  seam::BoundaryTest::make({.radius_mm = 4.0F}, arena)
      .value()
      .run(index, normals.view(map.size()), boundary, list);
  digest.add(CloudView{boundary.open_x.first(map.size()), boundary.open_y.first(map.size()),
                       boundary.open_z.first(map.size())});
  return digest.value();
}

/// The stages that start from a frame: fusing it, its points, normals from its pixels.
std::uint64_t digest_of_frame() {
  constexpr std::uint32_t kWidth = 133;
  constexpr std::uint32_t kHeight = 71;
  std::vector<std::uint16_t> counts(kWidth * kHeight);
  Pcg32 random(11);
  for (std::uint32_t i = 0; i < counts.size(); ++i) {
    const std::uint32_t edge = i % kWidth > 80 ? 900U : 0U;
    counts[i] = static_cast<std::uint16_t>(random.below(50) == 0
                                               ? 0
                                               : 25600 + 7 * (i % kWidth) - 11 * (i / kWidth) +
                                                     edge + random.below(4));
  }
  FrameFuser::View view;
  view.image = {{kWidth, kHeight, 180.0, 181.0, 66.25, 35.5}, 1.0 / 64.0, counts, {}};
  view.T_base_camera.rotation << 0.6, 0.8, 0.0, -0.8, 0.6, 0.0, 0.0, 0.0, 1.0;
  view.T_base_camera.translation_mm = {10.0, -20.0, 30.5};
  test::ArenaOwner memory(VoxelMap::bytes(counts.size()) + FrameFuser::bytes(kWidth) +
                          CloudBuffer::bytes(counts.size()) + NormalsBuffer::bytes(kWidth));
  auto map = VoxelMap::make({}, counts.size(), memory.arena()).value();
  auto fuser = FrameFuser::make({.max_step_mm = 5.0F}, kWidth, memory.arena()).value();
  fuser.run(view, map);
  Digest digest;
  digest.add(map.view().points);
  digest.add(map.view().count);
  CloudBuffer points(counts.size(), memory.arena());
  std::vector<std::uint32_t> storage(counts.size());
  Buffer<std::uint32_t> pixels(storage);
  depth::unproject(view.image, points, pixels);
  digest.add(points.view());
  digest.add(pixels.view());
  NormalsBuffer row(kWidth, memory.arena());
  const auto stage = OrganizedNormals::make({}).value();
  for (std::uint32_t v = 0; v < kHeight; ++v) {
    stage.run_row(view.image, v, row);
    digest.add(CloudView{row.nx, row.ny, row.nz});
    digest.add<float>(row.variation);
  }
  return digest.value();
}

struct Golden {
  Family family;
  std::uint64_t small;  ///< 12 clouds of 500 points and more.
};

constexpr Golden kGolden[] = {
    {Family::kSurface, 0xC95AB65BD3B05A6AULL},       {Family::kVolume, 0x2D2F8D84E2318454ULL},
    {Family::kLattice, 0xCA1E84AB093B5BE6ULL},       {Family::kIdentical, 0x12EB278B856D3262ULL},
    {Family::kDuplicates, 0x99133604FDBF8A7FULL},    {Family::kOneCell, 0xED0B342841E2025EULL},
    {Family::kOneFarOutlier, 0x06CDCC6362835B45ULL}, {Family::kHalfOutliers, 0xE838C8D8ADEE27E0ULL},
    {Family::kCollinear, 0x6E922071951F82C9ULL},     {Family::kCoplanar, 0x9B37421D67331F67ULL},
    {Family::kTwoPlanes, 0x7DFB18CF8EE97D6AULL},     {Family::kCellFaces, 0x61FF422CF54E2098ULL},
    {Family::kClusters, 0xCCB8134A9C64D8ABULL},      {Family::kNotFinite, 0x931A23B5A3F37ED3ULL},
};

TEST(GoldenDigest, the_rest_of_the_stages_gives_the_recorded_bits) {
  std::uint64_t all = 0;
  for (int family = 0; family < test::kNumFamilies; ++family) {
    all = all * 31 + digest_of_the_rest(test::make_cloud(static_cast<Family>(family), 700, 5));
  }
  EXPECT_EQ(all, 0xDE3ED382EFCC3BECULL);
}

TEST(GoldenDigest, the_stages_of_a_frame_give_the_recorded_bits) {
  EXPECT_EQ(digest_of_frame(), 0xF297140ED6B5CDD4ULL);
}

TEST(GoldenDigest, every_stage_gives_the_recorded_bits) {
  for (const Golden& golden : kGolden) {
    EXPECT_EQ(digest_of_family(golden.family, 12, 500), golden.small) << test::name(golden.family);
  }
}

}  // namespace
}  // namespace dseam::cloud
