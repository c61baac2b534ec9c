// SPDX-License-Identifier: Apache-2.0
// Registers two views of a nozzle on a shell from a start 2 mm and half a degree off, by dseam and
// by PCL on the same voxel clouds in one run; then finds and matches the markers of a frame beside
// decoding and fusing it.
//   splice_bench [SEEDS]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dseam/cloud/frame_fuser.hpp"
#include "dseam/markers/marker_finder.hpp"
#include "dseam/markers/marker_matcher.hpp"
#include "tables/view_pair.hpp"

namespace dseam::bench {
namespace {

constexpr int kRepetitions = 5;
constexpr std::size_t kMaxCells = 400000;
constexpr float kReachMm = 130.0F;

// Of this process: others on the machine do not count.
double now_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double least_ms_of(const auto& work) {
  double least = 1e300;
  for (int i = 0; i < kRepetitions; ++i) {
    const double begun = now_ms();
    work();
    least = std::min(least, now_ms() - begun);
  }
  return least;
}

struct Sum {
  double error_mm = 0.0;
  double ms = 0.0;
  int converged = 0;
};

void register_pairs(std::uint64_t seeds) {
  std::map<std::string, Sum> sums;
  std::vector<std::string> order;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const auto pair = std::make_unique<ViewPair>(seed);
    auto results = register_with_pcl(pair->source(), pair->target(), pair->start());
    results.push_back(by_our_icp(*pair, splice::IcpMetric::kPointToPlane));
    results.push_back(by_our_patches(*pair));
    for (const Registration& result : results) {
      if (!sums.contains(result.name)) {
        order.push_back(result.name);
      }
      Sum& sum = sums[result.name];
      sum.error_mm += pair->error_of(result.T_target_source).max_mm / static_cast<double>(seeds);
      sum.ms += result.ms / static_cast<double>(seeds);
      sum.converged += result.converged ? 1 : 0;
    }
  }
  std::printf("| method | largest displacement of the seam, mm | ms | converged |\n");
  std::printf("| --- | --- | --- | --- |\n");
  for (const std::string& name : order) {
    const Sum& sum = sums[name];
    std::printf("| %s | %.3f | %.1f | %d of %llu |\n", name.c_str(), sum.error_mm, sum.ms,
                sum.converged, static_cast<unsigned long long>(seeds));
  }
}

/// Markers of two neighbouring frames, and one of the frames into a map.
void time_markers() {
  const hal::sim::Cell cell = hal::sim::Cell::make({}).value();
  hal::sim::Rendering renderings[2];
  cell.scan(0, renderings[0]);
  cell.scan(1, renderings[1]);
  const hal::sim::ScannerConfig& scanner = cell.config().scanner;
  const depth::DepthImage frame = hal::sim::image_of(renderings[0], scanner);
  const depth::DepthImage before = hal::sim::image_of(renderings[1], scanner);
  test::ArenaOwner owner(markers::MarkerFinder::bytes(scanner.width) +
                         markers::MarkerMatcher::bytes(64) + cloud::VoxelMap::bytes(kMaxCells) +
                         cloud::FrameFuser::bytes(scanner.width));
  auto finder = markers::MarkerFinder::make({}, scanner.width, owner.arena()).value();
  auto matcher = markers::MarkerMatcher::make({}, 64, owner.arena()).value();
  auto map = cloud::VoxelMap::make({.cell_mm = 1.0F}, kMaxCells, owner.arena()).value();
  auto fuser = cloud::FrameFuser::make({}, scanner.width, owner.arena()).value();
  const Eigen::Vector3f centre = cell.config().T_base_part.translation_mm.cast<float>();
  cloud::OrientedBox box;
  box.low_mm = {centre.x() - kReachMm, centre.y() - kReachMm, centre.z() - kReachMm};
  box.high_mm = {centre.x() + kReachMm, centre.y() + kReachMm, centre.z() + kReachMm};
  fuser.set_box(box);
  std::vector<markers::Marker> storage(64);
  const auto places_of = [&](const depth::DepthImage& image) {
    Buffer<markers::Marker> found{std::span<markers::Marker>(storage)};
    (void)finder.run(image, found);
    std::vector<Eigen::Vector3d> places;
    for (const markers::Marker& marker : found.view()) {
      places.push_back(marker.p_camera);
    }
    return places;
  };
  const std::vector<Eigen::Vector3d> known = places_of(before);
  std::size_t matched = 0;
  const double markers_ms = least_ms_of([&] {
    (void)matcher.run(places_of(frame), known, std::nullopt);
    matched = matcher.num_pairs();
  });
  const double fuse_ms = least_ms_of([&] {
    map.relay(1.0F, {});
    (void)fuser.run({frame, cell.views()[0].T_base_camera, 0, {}}, map);
  });
  std::printf(
      "\nA frame of %u x %u: markers found and matched %.1f ms (%zu pairs), decoded, cropped "
      "and fused %.1f ms: %.2f of it\n",
      scanner.width, scanner.height, markers_ms, matched, fuse_ms, markers_ms / fuse_ms);
}

}  // namespace
}  // namespace dseam::bench

int main(int argc, char** argv) {
  dseam::bench::register_pairs(argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 3);
  dseam::bench::time_markers();
  return 0;
}
