// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/weld_pipeline.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <cstdlib>
#include <ostream>
#include <string>
#include <vector>

#include "dseam/hal/sim/cell.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"

namespace dseam::pipeline {
namespace {

/// Frames of a sixth of the usual width: every stage runs, in little time.
struct Scan {
  Scan() : cell(hal::sim::Cell::make(small()).value()), renderings(small().views.count) {
    for (std::size_t v = 0; v < renderings.size(); ++v) {
      cell.scan(v, renderings[v]);
      frames.push_back(hal::sim::image_of(renderings[v], cell.config().scanner));
      reported.push_back({true, cell.views()[v].T_base_camera_reported});
    }
  }
  static hal::sim::CellConfig small() {
    hal::sim::CellConfig config;
    config.scanner.width = 216;
    config.scanner.height = 161;
    config.views.count = 5;
    return config;
  }

  hal::sim::Cell cell;
  std::vector<hal::sim::Rendering> renderings;
  std::vector<depth::DepthImage> frames;
  std::vector<splice::ReportedPose> reported;
};

const Scan& scan() {
  static const Scan kScan;
  return kScan;
}

WeldPipeline::Capacity enough() {
  WeldPipeline::Capacity capacity;
  capacity.views.width = 216;
  capacity.views.height = 161;
  capacity.views.max_views = 5;
  capacity.max_voxels = 60000;
  capacity.seam.max_points = 60000;
  return capacity;
}

/// Half of the fine cells: so coarse an image fills no finer ones.
WeldPipeline::Config config() {
  WeldPipeline::Config config;
  config.coarse_cell_mm = 6.0;
  config.fine_cell_mm = 2.0;
  return config;
}

class WeldPipelineTest : public ::testing::Test {
 protected:
  explicit WeldPipelineTest(const WeldPipeline::Capacity& capacity = enough())
      : memory_(WeldPipeline::bytes(capacity)),
        pipeline_(WeldPipeline::make(config(), capacity, memory_.arena()).value()) {}

  WeldReport pass() {
    pipeline_->clear();
    for (std::size_t v = 0; v < scan().frames.size(); ++v) {
      pipeline_->add(scan().frames[v], scan().reported[v]);
    }
    return pipeline_->finish();
  }

  test::ArenaOwner memory_;
  WeldPipeline* pipeline_;
};

/// FNV-1a over the raw bits of all coordinates.
std::uint64_t digest_of(std::span<const seam::SeamPoint> points) {
  std::uint64_t digest = 14695981039346656037ULL;
  for (const seam::SeamPoint& point : points) {
    for (const double value : {point.p_base.x(), point.p_base.y(), point.p_base.z(), point.s_mm,
                               point.sigma_lateral_mm, point.dihedral_rad}) {
      digest = (digest ^ std::bit_cast<std::uint64_t>(value)) * 1099511628211ULL;
    }
  }
  return digest;
}

TEST_F(WeldPipelineTest, a_hundred_passes_take_no_memory_and_give_the_same_bits) {
  const WeldReport first = pass();
  const std::uint64_t digest = digest_of(pipeline_->seam_points());
  ASSERT_EQ(first.fault, ScanFault::kNone);
  ASSERT_FALSE(pipeline_->seam_points().empty()) << name(first.seam.refusal);

  const test::AllocationCounter allocations;
  std::uint32_t other_digests = 0;
  for (int i = 0; i < 100; ++i) {
    pass();
    other_digests += digest_of(pipeline_->seam_points()) != digest ? 1U : 0U;
  }
  const std::uint64_t allocated = allocations.count();

  EXPECT_EQ(allocated, 0U);
  EXPECT_EQ(other_digests, 0U);
}

// The other process runs this very test, and prints instead of asking a third.
TEST_F(WeldPipelineTest, two_processes_give_the_same_bits) {
  pass();
  const auto here = static_cast<unsigned long long>(digest_of(pipeline_->seam_points()));
  if (std::getenv("DSEAM_PRINT_DIGEST") != nullptr) {
    std::printf("digest %llu\n", here);
    return;
  }

  std::FILE* other =
      popen("DSEAM_PRINT_DIGEST=1 " DSEAM_THIS_TEST " --gtest_filter=*two_processes*", "r");
  ASSERT_NE(other, nullptr);
  std::string text;
  for (int c = std::fgetc(other); c != EOF; c = std::fgetc(other)) {
    text += static_cast<char>(c);
  }
  EXPECT_EQ(pclose(other), 0);

  EXPECT_NE(text.find("digest " + std::to_string(here) + '\n'), std::string::npos) << text;
}

TEST_F(WeldPipelineTest, a_frame_more_than_there_are_places_is_not_kept) {
  pass();

  const TakeInReport report = pipeline_->add(scan().frames[0], scan().reported[0]);

  EXPECT_FALSE(report.kept);
  EXPECT_EQ(report.error, Errc::kOutOfMemory);
}

TEST(WeldPipelineMemory, an_arena_a_tenth_too_small_is_refused) {
  test::ArenaOwner memory(WeldPipeline::bytes(enough()) / 10 * 9);

  EXPECT_EQ(WeldPipeline::make(config(), enough(), memory.arena()).error(), Errc::kOutOfMemory);
}

TEST(WeldPipelineMemory, the_paper_scanners_six_frames_and_600000_voxels_fit_the_stated_budget) {
  constexpr std::size_t kMiB = 1U << 20U;
  WeldPipeline::Capacity capacity;
  capacity.views.max_views = 6;
  capacity.seam.max_points = capacity.max_voxels;

  EXPECT_EQ(capacity.views.width, 1296U);
  EXPECT_EQ(capacity.views.height, 966U);
  EXPECT_EQ(capacity.max_voxels, 600000U);
  EXPECT_LE(WeldPipeline::bytes(capacity), 256 * kMiB);
}

/// A workspace in which one buffer is too small for the scan, and how that must come out.
struct Overflow {
  const char* name;
  void (*shrink)(WeldPipeline::Capacity& capacity);
  bool all_kept;
  ScanFault fault;
  seam::Refusal refusal;
};

void PrintTo(const Overflow& overflow, std::ostream* out) { *out << overflow.name; }

class WeldPipelineOverflow : public ::testing::TestWithParam<Overflow> {};

TEST_P(WeldPipelineOverflow, ends_in_a_refusal_and_never_in_a_seam) {
  WeldPipeline::Capacity capacity = enough();
  GetParam().shrink(capacity);
  test::ArenaOwner memory(WeldPipeline::bytes(capacity));
  WeldPipeline* pipeline = WeldPipeline::make(config(), capacity, memory.arena()).value();
  bool all_kept = true;
  for (std::size_t v = 0; v < scan().frames.size(); ++v) {
    all_kept = pipeline->add(scan().frames[v], scan().reported[v]).kept && all_kept;
  }

  const WeldReport report = pipeline->finish();

  EXPECT_EQ(all_kept, GetParam().all_kept);
  EXPECT_EQ(report.fault, GetParam().fault) << name(report.fault);
  EXPECT_EQ(report.seam.refusal, GetParam().refusal) << name(report.seam.refusal);
  EXPECT_FALSE(all_kept && report.weld());
}

using seam::Refusal;

// A view that is not kept is told at add(); the program then ends without a seam.
INSTANTIATE_TEST_SUITE_P(
    Buffers, WeldPipelineOverflow,
    ::testing::Values(Overflow{"pixels", [](WeldPipeline::Capacity& c) { c.views.width = 200; },
                               false, ScanFault::kNoView, Refusal::kEmptyCloud},
                      Overflow{"voxels", [](WeldPipeline::Capacity& c) { c.max_voxels = 1500; },
                               true, ScanFault::kMapFull, Refusal::kEmptyCloud},
                      Overflow{"cells", [](WeldPipeline::Capacity& c) { c.seam.max_points = 256; },
                               true, ScanFault::kNone, Refusal::kLowCoverage},
                      Overflow{"seam_points",
                               [](WeldPipeline::Capacity& c) { c.max_seam_points = 64; }, true,
                               ScanFault::kNone, Refusal::kFull}),
    [](const auto& overflow) { return std::string(overflow.param.name); });

}  // namespace
}  // namespace dseam::pipeline
