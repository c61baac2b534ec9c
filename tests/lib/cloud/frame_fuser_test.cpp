// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/frame_fuser.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dseam/cloud/organized_normals.hpp"
#include "dseam/depth/unproject.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"

namespace dseam::cloud {
namespace {

using geometry::Vec3f;

constexpr std::uint32_t kWidth = 53;  // No multiple of eight.
constexpr std::uint32_t kHeight = 31;

/// A tilted plane seen by a small camera, and somewhere to fuse it.
class FrameFuserTest : public ::testing::Test {
 protected:
  FrameFuserTest() {
    view_.image.intrinsics = {kWidth, kHeight, 80.0, 82.0, 25.5, 14.0};
    view_.image.mm_per_count = 0.015625;
    for (std::uint32_t v = 0; v < kHeight; ++v) {
      for (std::uint32_t u = 0; u < kWidth; ++u) {
        counts_[v * kWidth + u] = static_cast<std::uint16_t>(plane_depth_mm(u, v) * 64.0 + 0.5);
      }
    }
    view_.image.depth = counts_;
    view_.T_base_camera = {geometry::rotation_exp({0.3, -0.2, 1.1}), {10.0, -5.0, 400.0}};
  }

  // 0.2 x - 0.1 y + z = 300 along the pixel's ray.
  double plane_depth_mm(std::uint32_t u, std::uint32_t v) const {
    const depth::Intrinsics& k = view_.image.intrinsics;
    return 300.0 / (0.2 * (u - k.cx) / k.fx - 0.1 * (v - k.cy) / k.fy + 1.0);
  }
  Eigen::Vector3d base_point(std::uint32_t u, std::uint32_t v) const {
    const depth::Intrinsics& k = view_.image.intrinsics;
    const double z = counts_[v * kWidth + u] * view_.image.mm_per_count;
    return view_.T_base_camera * Eigen::Vector3d((u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z);
  }
  FrameFuser make(const FrameFuser::Config& config = {}) {
    return FrameFuser::make(config, kWidth, memory_.arena()).value();
  }

  std::vector<std::uint16_t> counts_ = std::vector<std::uint16_t>(kWidth * kHeight);
  FrameFuser::View view_;
  test::ArenaOwner memory_{VoxelMap::bytes(5000) + 4 * FrameFuser::bytes(kWidth)};
  // Cells so small that each holds one pixel.
  VoxelMap map_ = VoxelMap::make({.cell_mm = 0.05F}, 5000, memory_.arena()).value();
};

TEST_F(FrameFuserTest, every_pixel_arrives_where_double_arithmetic_puts_it) {
  FrameFuser fuser = make();
  view_.number = 5;

  const auto report = fuser.run(view_, map_);

  EXPECT_EQ(report.pixels, kWidth * kHeight);
  EXPECT_EQ(report.map.inserted, kWidth * kHeight);
  const FusedCloudView fused = map_.view();
  ASSERT_EQ(fused.points.size(), kWidth * kHeight);
  for (std::uint32_t i = 0; i < fused.points.size(); ++i) {
    const Eigen::Vector3d truth = base_point(i % kWidth, i / kWidth);
    EXPECT_NEAR(fused.points.x[i], truth.x(), 2e-4);
    EXPECT_NEAR(fused.points.y[i], truth.y(), 2e-4);
    EXPECT_NEAR(fused.points.z[i], truth.z(), 2e-4);
    EXPECT_EQ(fused.seen_by[i], 1U << 5U);
  }
}

TEST_F(FrameFuserTest, an_oriented_box_of_base_crops) {
  OrientedBox box;
  box.T_box_cloud = {{0.0F, 1.0F, 0.0F}, {-1.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F}, {}};
  box.low_mm.x = 0.0F;  // y of base.
  FrameFuser fuser = make({.box = box});
  std::uint32_t inside = 0;
  for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
    inside += base_point(i % kWidth, i / kWidth).y() >= 0.0 ? 1U : 0U;
  }

  const auto report = fuser.run(view_, map_);

  EXPECT_EQ(report.map.inserted, inside);
  EXPECT_EQ(report.dropped_outside, kWidth * kHeight - inside);
}

TEST_F(FrameFuserTest, pixels_without_depth_and_masked_ones_are_counted_and_skipped) {
  FrameFuser fuser = make();
  std::vector<std::uint8_t> masked(counts_.size(), 0);
  counts_[3] = 0;
  counts_[4] = 0;
  masked[4] = 255;
  masked[kWidth] = 1;

  view_.masked = masked;
  const auto report = fuser.run(view_, map_);

  EXPECT_EQ(report.without_depth, 2U);
  EXPECT_EQ(report.dropped_masked, 1U);
  EXPECT_EQ(report.map.inserted, kWidth * kHeight - 3U);
}

TEST_F(FrameFuserTest, a_pixel_between_two_surfaces_flies_and_the_edges_beside_it_do_not) {
  FrameFuser fuser = make({.max_step_mm = 3.0F});
  for (std::uint32_t v = 0; v < kHeight; ++v) {
    counts_[v * kWidth + 20] = 250 * 64;
    for (std::uint32_t u = 21; u < kWidth; ++u) {
      counts_[v * kWidth + u] = 200 * 64;
    }
  }

  const auto report = fuser.run(view_, map_);

  EXPECT_EQ(report.dropped_flying, kHeight);
}

TEST_F(FrameFuserTest, a_stride_takes_every_nth_pixel_of_every_nth_row) {
  FrameFuser fuser = make({.pixel_stride = 3});

  const auto report = fuser.run(view_, map_);

  EXPECT_EQ(report.pixels, 18U * 11U);
  const Eigen::Vector3d truth = base_point(3 * 17, 3 * 10);
  EXPECT_NEAR(map_.view().points.x[18 * 11 - 1], truth.x(), 2e-4);
}

TEST_F(FrameFuserTest, images_of_the_wrong_shape_are_not_fused) {
  FrameFuser fuser = make();
  auto cut = view_;
  cut.image.depth = cut.image.depth.first(10);
  auto wide = view_;
  wide.image.intrinsics.width = kWidth * kHeight;
  wide.image.intrinsics.height = 1;
  auto mask = view_;
  const std::vector<std::uint8_t> short_mask(7);
  mask.masked = short_mask;

  EXPECT_EQ(fuser.run(cut, map_).pixels, 0U);
  EXPECT_EQ(fuser.run(wide, map_).pixels, 0U);
  EXPECT_EQ(fuser.run(mask, map_).pixels, 0U);
}

TEST_F(FrameFuserTest, a_pose_that_is_not_finite_fuses_nothing) {
  FrameFuser fuser = make();
  view_.T_base_camera.translation_mm.x() = NAN;

  EXPECT_EQ(fuser.run(view_, map_).map.inserted, 0U);
  EXPECT_EQ(map_.size(), 0U);
}

TEST_F(FrameFuserTest, fusing_allocates_nothing) {
  FrameFuser fuser = make({.max_step_mm = 3.0F});
  const test::AllocationCounter allocations;

  fuser.run(view_, map_);

  EXPECT_EQ(allocations.count(), 0U);
}

TEST_F(FrameFuserTest, unproject_gives_the_same_points_in_the_cameras_frame) {
  std::vector<float> x(kWidth * kHeight);
  std::vector<float> y(x);
  std::vector<float> z(x);
  std::vector<std::uint32_t> storage(x.size());
  CloudBuffer cloud(x, y, z);
  Buffer<std::uint32_t> pixels(storage);
  counts_[0] = 0;

  const auto report = depth::unproject(view_.image, cloud, pixels);

  EXPECT_EQ(report.points, kWidth * kHeight - 1);
  EXPECT_EQ(report.without_depth, 1U);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3f p = cloud[i];
    const Eigen::Vector3d base =
        view_.T_base_camera * Eigen::Vector3d(static_cast<double>(p.x), static_cast<double>(p.y),
                                              static_cast<double>(p.z));
    EXPECT_LT((base - base_point(pixels[i] % kWidth, pixels[i] / kWidth)).norm(), 1e-3);
  }
}

TEST_F(FrameFuserTest, organized_normals_are_those_of_the_plane_and_look_at_the_camera) {
  const auto stage = OrganizedNormals::make({}).value();
  const float length = std::sqrt(0.04F + 0.01F + 1.0F);
  test::ArenaOwner memory(NormalsBuffer::bytes(kWidth));
  NormalsBuffer row(kWidth, memory.arena());
  for (std::uint32_t v = 0; v < kHeight; ++v) {
    EXPECT_EQ(stage.run_row(view_.image, v, row), kWidth);
    for (std::uint32_t u = 0; u < kWidth; ++u) {
      EXPECT_NEAR(row.nx[u], -0.2F / length, 5e-3F);
      EXPECT_NEAR(row.ny[u], 0.1F / length, 5e-3F);
      EXPECT_NEAR(row.nz[u], -1.0F / length, 5e-3F);
      EXPECT_EQ(stage.at(view_.image, u, v).direction, row[u]);
    }
  }
}

TEST_F(FrameFuserTest, organized_normals_do_not_cross_a_step_and_name_what_is_missing) {
  const auto stage = OrganizedNormals::make({}).value();
  for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
    counts_[i] = i % kWidth < 26 ? 200 * 64 : 300 * 64;
  }
  counts_[10] = 0;

  EXPECT_NEAR(stage.at(view_.image, 25, 15).direction.z, -1.0F, 1e-4F);
  EXPECT_NEAR(stage.at(view_.image, 26, 15).direction.z, -1.0F, 1e-4F);
  EXPECT_EQ(stage.at(view_.image, 10, 0).state, NormalState::kTooFew);
  EXPECT_EQ(stage.at(view_.image, kWidth, 0).state, NormalState::kTooFew);
}

}  // namespace
}  // namespace dseam::cloud
