// SPDX-License-Identifier: Apache-2.0
#include "program/support/cell_figures.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace dseam::program::test {
namespace {

std::ifstream open_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) {
    throw std::runtime_error(path + " is missing");
  }
  return file;
}

std::vector<std::vector<std::string>> rows_of(const std::string& path) {
  std::ifstream file = open_file(path);
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(file, line);  // The header.
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) {
      rows.back().push_back(cell);
    }
  }
  return rows;
}

Eigen::Vector3d vector_at(const std::vector<std::string>& row, std::size_t column) {
  return {std::stod(row.at(column)), std::stod(row.at(column + 1)), std::stod(row.at(column + 2))};
}

hal::sim::TruthCurve truth_in(const std::string& path) {
  hal::sim::TruthCurve curve;
  for (const auto& row : rows_of(path)) {
    curve.points.push_back({std::stod(row.at(0)), vector_at(row, 1), vector_at(row, 4),
                            vector_at(row, 7), vector_at(row, 10), std::stod(row.at(13))});
  }
  const hal::sim::TruthPoint& last = curve.points.back();
  curve.length_mm = last.s_mm + (curve.points.front().p - last.p).norm();
  return curve;
}

std::vector<seam::SeamPoint> seam_in(const std::string& path) {
  std::vector<seam::SeamPoint> points;
  for (const auto& row : rows_of(path)) {
    seam::SeamPoint point;
    point.s_mm = std::stod(row.at(0));
    point.p_base = vector_at(row, 1);
    point.source = row.back() == "measured" ? seam::Source::kMeasured : seam::Source::kInterpolated;
    points.push_back(point);
  }
  return points;
}

geometry::RigidTransform pose_in(const nlohmann::json& view) {
  geometry::RigidTransform pose;
  const auto& values = view.at("T_base_camera");
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      pose.rotation(row, column) = values.at(static_cast<std::size_t>(4 * row + column));
    }
    pose.translation_mm(row) = values.at(static_cast<std::size_t>(4 * row + 3));
  }
  return pose;
}

std::vector<dseam::test::ViewPoses> poses_in(const std::string& found, const std::string& truth) {
  std::vector<dseam::test::ViewPoses> poses;
  std::ifstream found_file = open_file(found);
  std::ifstream truth_file = open_file(truth);
  const auto adjusted = nlohmann::json::parse(found_file);
  const auto real = nlohmann::json::parse(truth_file);
  for (const auto& [view, pose] : adjusted.items()) {
    poses.push_back({pose_in(real.at(view)), pose_in(pose)});
  }
  return poses;
}

}  // namespace

dseam::test::SeamAccuracy score_weld(const std::string& out, const std::string& truth) {
  const hal::sim::TruthCurve curve = truth_in(truth + "/truth_seam.csv");
  const auto poses = poses_in(out + "/poses.json", truth + "/truth_poses.json");
  return dseam::test::measure_seam(seam_in(out + "/seam.csv"), curve,
                                   dseam::test::base_correction(poses, curve));
}

}  // namespace dseam::program::test
