// SPDX-License-Identifier: Apache-2.0
// Runs each stage of the core once over a surface of as many points as it is told, at constant
// density and in the order of a scan or shuffled, each in a function of its own, so that callgrind
// can count; check_growth.py judges.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

#include "core_chain.hpp"
#include "support/shapes/clouds.hpp"

namespace dseam::bench {
namespace {

// Row by row, 0.75 mm apart as the points are.
test::OwnedCloud in_order_of_a_scan(const test::OwnedCloud& cloud) {
  std::vector<std::pair<int, float>> places;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    places.emplace_back(static_cast<int>((cloud.y[i] + 50.0F) / 0.75F), cloud.x[i]);
  }
  std::vector<std::uint32_t> order(cloud.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return places[a] < places[b]; });
  test::OwnedCloud scan;
  for (const std::uint32_t i : order) {
    scan.add(cloud.x[i], cloud.y[i], cloud.z[i]);
  }
  return scan;
}

// The names are read by the script.
[[gnu::noinline]] void growth_outliers(CoreChain& chain) { chain.clean(); }
[[gnu::noinline]] void growth_voxels(CoreChain& chain) { chain.downsample(); }
[[gnu::noinline]] void growth_normals(CoreChain& chain) {
  chain.index_cells();
  chain.estimate_normals();
}
[[gnu::noinline]] void growth_boundary(CoreChain& chain) { chain.find_boundary(); }

/// The least of as many runs as take a second, at least three: what else runs on the machine only
/// ever adds.
double least_ms(CoreChain& chain, void (*stage)(CoreChain&)) {
  using Clock = std::chrono::steady_clock;
  const auto ms = [](Clock::duration d) {
    return std::chrono::duration<double, std::milli>(d).count();
  };
  const Clock::time_point begin = Clock::now();
  double least = 1.0e9;
  for (int run = 0; run < 3 || ms(Clock::now() - begin) < 1000.0; ++run) {
    const Clock::time_point start = Clock::now();
    stage(chain);
    least = std::min(least, ms(Clock::now() - start));
  }
  return least;
}

}  // namespace
}  // namespace dseam::bench

int main(int argc, char** argv) {
  using namespace dseam::bench;
  if (argc != 4) {
    std::fputs("core_growth POINTS once|timed scanned|shuffled\n", stderr);
    return 2;
  }
  auto cloud =
      dseam::test::make_cloud(dseam::test::Family::kSurface, std::strtoul(argv[1], nullptr, 10), 1);
  if (std::string_view(argv[3]) == "scanned") {
    cloud = in_order_of_a_scan(cloud);
  }
  CoreChain chain(cloud, 1.0F, 2.5F);  // Which runs every stage once.
  constexpr std::pair<const char*, void (*)(CoreChain&)> kStages[] = {
      {"outliers", growth_outliers},
      {"voxels", growth_voxels},
      {"normals", growth_normals},
      {"boundary", growth_boundary}};
  for (const auto& [name, stage] : kStages) {
    if (std::string_view(argv[2]) == "timed") {
      std::printf("%s %.3f\n", name, least_ms(chain, stage));
    } else {
      stage(chain);
    }
  }
  return 0;
}
