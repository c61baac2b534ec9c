// SPDX-License-Identifier: Apache-2.0
// Writes simulated scan sets with their truth: OUT/ROW_SEED/set and OUT/ROW_SEED/truth.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "dseam/hal/replay/scan_set.hpp"
#include "dseam/hal/sim/cell.hpp"
#include "support/accuracy/cell_rows.hpp"

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
  bool flange_poses = false;
};

/// Where the camera sits on the flange when flange poses are written.
geometry::RigidTransform flange_camera() {
  return {geometry::rotation_exp({0.05, -0.08, 1.2}), {62.0, -35.0, 118.0}};
}

hal::replay::ScanView view_of(const hal::sim::Cell& cell, std::uint32_t i,
                              hal::sim::Rendering rendering, const Arguments& arguments) {
  hal::replay::ScanView view;
  view.camera.id = i;
  view.camera.intrinsics = intrinsics(cell.config().scanner);
  view.camera.mm_per_count = cell.config().scanner.mm_per_count;
  view.camera.stamp_ns = 1'000'000'000LL * i;
  const geometry::RigidTransform& reported = cell.views()[i].T_base_camera_reported;
  if (arguments.flange_poses) {
    view.camera.T_base_flange = reported * flange_camera().inverse();
  } else if (!arguments.without_poses) {
    view.camera.T_base_camera = reported;
  }
  view.depth = std::move(rendering.depth);
  view.gray = std::move(rendering.gray);
  return view;
}

bool write_hand_eye(const fs::path& file) {
  std::ofstream out(file);
  out.precision(17);
  out << "{\"T_flange_camera\": [";
  const char* comma = "";
  for (const double value : geometry::to_row_major(flange_camera())) {
    out << comma << value;
    comma = ", ";
  }
  out << "]}\n";
  out.close();
  return !out.fail();
}

std::optional<std::string> write_set(const hal::sim::Cell& cell, const fs::path& dir,
                                     const Arguments& arguments) {
  auto writer = hal::replay::ScanSetWriter::create(dir / "set");
  if (!writer.ok()) {
    return writer.fault();
  }
  for (std::uint32_t i = 0; i < cell.views().size(); ++i) {
    hal::sim::Rendering rendering;
    cell.scan(i, rendering);
    const auto view = view_of(cell, i, std::move(rendering), arguments);
    if (const auto fault = writer.value().add(view)) {
      return fault->text;
    }
  }
  if (const auto fault = writer.value().commit()) {
    return fault->text;
  }
  fs::create_directories(dir / "truth");
  const bool written = write_truth(cell, dir / "truth").ok() &&
                       (!arguments.flange_poses || write_hand_eye(dir / "truth/hand_eye.json"));
  return written ? std::nullopt : std::optional(dir.string() + "/truth: cannot be written");
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
  return cell.ok() ? write_set(cell.value(), dir, arguments)
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
  app.add_flag("--flange-poses", arguments.flange_poses,
               "write T_base_flange instead of camera poses, and truth/hand_eye.json");
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
