// SPDX-License-Identifier: Apache-2.0
#include "input/cloud_reader.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "failure.hpp"

namespace dseam::program {
namespace {

using Parser = LoadedCloud (*)(const std::string&, double);

Parser parser_of(const std::string& bytes) {
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r\n")) {
    return parse_ply;
  }
  if (bytes.starts_with("# .PCD") || bytes.starts_with("VERSION")) {
    return parse_pcd;
  }
  throw std::runtime_error("neither a PLY nor a PCD file");
}

LoadedCloud checked(LoadedCloud cloud) {
  if (cloud.size() == 0) {
    throw std::runtime_error(cloud.num_not_finite == 0 ? "holds no points"
                                                       : "holds no finite point");
  }
  return cloud;
}

}  // namespace

void LoadedCloud::add(double x_mm, double y_mm, double z_mm) {
  const auto fits = [](double value) { return std::isfinite(static_cast<float>(value)); };
  if (!fits(x_mm) || !fits(y_mm) || !fits(z_mm)) {
    ++num_not_finite;
    return;
  }
  x.push_back(static_cast<float>(x_mm));
  y.push_back(static_cast<float>(y_mm));
  z.push_back(static_cast<float>(z_mm));
}

std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file)) {
    throw Failure(ExitCode::kInput, file.string() + ": cannot be read");
  }
  return {std::istreambuf_iterator<char>(in), {}};
}

LoadedCloud read_cloud(const std::filesystem::path& file, double mm_per_unit) {
  const std::string bytes = read_bytes(file);
  try {
    return checked(parser_of(bytes)(bytes, mm_per_unit));
  } catch (const std::runtime_error& fault) {
    throw Failure(ExitCode::kInput, file.string() + ": " + fault.what());
  }
}

LoadedCloud read_csv_points(const std::filesystem::path& file, double mm_per_unit) {
  const std::string bytes = read_bytes(file);
  try {
    return checked(parse_csv(bytes, mm_per_unit));
  } catch (const std::runtime_error& fault) {
    throw Failure(ExitCode::kInput, file.string() + ": " + fault.what());
  }
}

}  // namespace dseam::program
