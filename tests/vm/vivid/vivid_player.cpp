// SPDX-License-Identifier: Apache-2.0
// vivid_player SET LOG: shows the views of a scan set to two vivid cameras, the depth to
// /dev/video0 and the gray to /dev/video2, until it is killed. Follows what `dseam weld` writes to
// LOG: at "scanning: I of N" it shows view I.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <vector>

#include "dseam/depth/sample_layout.hpp"
#include "dseam/hal/replay/scan_set.hpp"
#include "vivid_output.hpp"

using dseam::depth::fourcc;
using dseam::test::VividOutput;

int main(int argc, char** argv) {
  if (argc != 3) {
    return 2;
  }
  auto loaded = dseam::hal::replay::read_scan_set(argv[1]);
  if (!loaded.ok()) {
    std::cerr << loaded.fault() << '\n';
    return 3;
  }
  const dseam::hal::replay::ScanSet set = std::move(loaded.value());
  const auto depth_of = [&](std::size_t i) { return std::as_bytes(std::span(set.views[i].depth)); };
  const auto gray_of = [&](std::size_t i) { return std::as_bytes(std::span(set.views[i].gray)); };
  VividOutput depth(0, fourcc('Y', '1', '6', ' '), depth_of(0));
  VividOutput gray(2, fourcc('G', 'R', 'E', 'Y'), gray_of(0));
  std::cout << (depth.ok() && gray.ok() ? "playing" : "refused") << std::endl;
  std::ifstream log(argv[2]);
  for (std::string line; depth.ok() && gray.ok();) {
    unsigned view = 0;
    if (!std::getline(log, line)) {
      log.clear();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      continue;
    }
    if (std::sscanf(line.c_str(), "scanning: %u of", &view) == 1 && view < set.views.size()) {
      depth.show(depth_of(view));
      gray.show(gray_of(view));
    }
  }
  return 5;
}
