// SPDX-License-Identifier: Apache-2.0
// Writes simulated scan sets with their truth: OUT/ROW_SEED/set and OUT/ROW_SEED/truth.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "dseam/hal/replay/scan_set.hpp"
#include "dseam/hal/sim/cell.hpp"
#include "support/cell_rows.hpp"

namespace {

namespace fs = std::filesystem;
using namespace dseam;

struct Arguments {
  fs::path out;
  std::vector<std::string> rows{"round"};
  std::uint64_t first_seed = 1;
  std::uint64_t num_seeds = 1;
  std::uint32_t width = 1296;
  std::uint32_t height = 966;
  bool without_poses = false;
};

hal::replay::ScanView view_of(const hal::sim::Cell& cell, std::uint32_t i,
                              hal::sim::Rendering rendering, bool without_pose) {
  hal::replay::ScanView view;
  view.camera.id = i;
  view.camera.intrinsics = intrinsics(cell.config().scanner);
  view.camera.mm_per_count = cell.config().scanner.mm_per_count;
  view.camera.stamp_ns = 1'000'000'000LL * i;
  if (!without_pose) {
    view.camera.T_base_camera = cell.views()[i].T_base_camera_reported;
  }
  view.depth = std::move(rendering.depth);
  view.gray = std::move(rendering.gray);
  return view;
}

std::optional<std::string> write_set(const hal::sim::Cell& cell, const fs::path& dir,
                                     bool without_poses) {
  auto writer = hal::replay::ScanSetWriter::create(dir / "set");
  if (!writer.ok()) {
    return writer.fault();
  }
  for (std::uint32_t i = 0; i < cell.views().size(); ++i) {
    hal::sim::Rendering rendering;
    cell.scan(i, rendering);
    const auto view = view_of(cell, i, std::move(rendering), without_poses);
    if (const auto fault = writer.value().add(view)) {
      return fault->text;
    }
  }
  if (const auto fault = writer.value().commit()) {
    return fault->text;
  }
  fs::create_directories(dir / "truth");
  return write_truth(cell, dir / "truth").ok()
             ? std::nullopt
             : std::optional(dir.string() + "/truth: cannot be written");
}

std::optional<std::string> write_one(const Arguments& arguments, const std::string& row,
                                     std::uint64_t seed) {
  auto config = test::cell_of_row(row, seed);
  if (!config) {
    return row + ": no such row";
  }
  config->scanner.width = arguments.width;
  config->scanner.height = arguments.height;
  const auto cell = hal::sim::Cell::make(*config);
  const fs::path dir = arguments.out / (row + "_" + std::to_string(seed));
  return cell.ok() ? write_set(cell.value(), dir, arguments.without_poses)
                   : std::optional(row + ": " + fault_in(*config));
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Writes simulated scan sets with their truth");
  app.add_option("--out", arguments.out, "folder to write into")->required();
  app.add_option("--row", arguments.rows, "kinds of workpiece; `all` for every one");
  app.add_option("--seed", arguments.first_seed, "first seed");
  app.add_option("--count", arguments.num_seeds, "how many seeds of each row");
  app.add_option("--width", arguments.width, "pixels");
  app.add_option("--height", arguments.height, "pixels");
  app.add_flag("--without-poses", arguments.without_poses, "leave the robot's poses out");
  CLI11_PARSE(app, argc, argv);

  if (arguments.rows == std::vector<std::string>{"all"}) {
    arguments.rows.assign(test::cell_rows().begin(), test::cell_rows().end());
  }
  for (const std::string& row : arguments.rows) {
    for (std::uint64_t i = 0; i < arguments.num_seeds; ++i) {
      const std::uint64_t seed = arguments.first_seed + i;
      if (const auto fault = write_one(arguments, row, seed)) {
        std::cerr << *fault << '\n';
        return 3;
      }
      std::cout << row << "_" << seed << '\n';
    }
  }
  return 0;
}
