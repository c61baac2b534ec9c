// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/replay/scan_set.hpp"

#include <gtest/gtest.h>

#include "small_set.hpp"

namespace dseam::test {
namespace {

using hal::replay::read_scan_set;
using hal::replay::ScanSetWriter;

TEST(ScanSet, what_was_written_is_read_again) {
  const ScratchFolder folder("scan_set");
  hal::replay::ScanSet set = small_set(3);
  set.views[1].camera.T_base_camera.reset();
  set.views[2].camera.T_base_flange = geometry::RigidTransform{};

  ASSERT_TRUE(write_set(set, folder / "set"));
  const auto read = read_scan_set(folder / "set");

  ASSERT_TRUE(read.ok()) << read.fault();
  ASSERT_EQ(read.value().views.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& view = read.value().views[i];
    EXPECT_EQ(view.depth, set.views[i].depth);
    EXPECT_EQ(view.gray, set.views[i].gray);
    EXPECT_EQ(view.camera.id, i);
    EXPECT_EQ(view.camera.intrinsics.width, 16U);
    EXPECT_EQ(view.camera.intrinsics.fy, 41.0);
    EXPECT_EQ(view.camera.mm_per_count, 0.1);
    EXPECT_EQ(view.camera.stamp_ns, set.views[i].camera.stamp_ns);
  }
  EXPECT_FALSE(read.value().views[1].camera.T_base_camera);
  EXPECT_TRUE(read.value().views[2].camera.T_base_flange);
  EXPECT_LT(geometry::difference(*read.value().views[2].camera.T_base_camera,
                                 *set.views[2].camera.T_base_camera)
                .norm(),
            1e-9);
}

TEST(ScanSet, gray_images_stamps_and_poses_may_be_absent) {
  const ScratchFolder folder("scan_set");
  hal::replay::ScanSet set = small_set(1);
  set.views[0].gray.clear();
  set.views[0].camera.T_base_camera.reset();
  set.views[0].camera.stamp_ns.reset();

  ASSERT_TRUE(write_set(set, folder / "set"));
  const auto read = read_scan_set(folder / "set");

  ASSERT_TRUE(read.ok()) << read.fault();
  EXPECT_TRUE(read.value().views[0].gray.empty());
  EXPECT_FALSE(read.value().views[0].camera.T_base_camera);
  EXPECT_FALSE(read.value().views[0].camera.stamp_ns);
}

TEST(ScanSetWriter, an_uncommitted_set_leaves_nothing_behind) {
  const ScratchFolder folder("scan_set");
  {
    auto writer = ScanSetWriter::create(folder / "set");
    ASSERT_TRUE(writer.ok());
    ASSERT_FALSE(writer.value().add(small_set(1).views[0]));
    EXPECT_FALSE(std::filesystem::exists(folder / "set"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "set"));
  EXPECT_FALSE(std::filesystem::exists(folder / "set.partial"));
}

TEST(ScanSetWriter, an_existing_set_is_never_written_over) {
  const ScratchFolder folder("scan_set");
  ASSERT_TRUE(write_set(small_set(1), folder / "set"));

  const auto writer = ScanSetWriter::create(folder / "set");

  ASSERT_FALSE(writer.ok());
  EXPECT_NE(writer.fault().find("exists already"), std::string::npos);
}

TEST(ScanSetWriter, a_folder_that_cannot_be_made_is_named) {
  const auto writer = ScanSetWriter::create("/proc/no_such_place/set");

  ASSERT_FALSE(writer.ok());
  EXPECT_NE(writer.fault().find("/proc/no_such_place/set: cannot be made"), std::string::npos);
}

TEST(ScanSetWriter, images_that_do_not_fit_their_camera_are_refused) {
  const ScratchFolder folder("scan_set");
  auto writer = ScanSetWriter::create(folder / "set");
  hal::replay::ScanView view = small_set(1).views[0];
  view.gray.pop_back();

  EXPECT_TRUE(writer.value().add(view));
}

}  // namespace
}  // namespace dseam::test
