// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "dseam/hal/replay/scan_set.hpp"

namespace dseam::hal::replay {
namespace {

using geometry::RigidTransform;
using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& text) { throw std::runtime_error(text); }

double finite_number(const Json& value, const std::string& name) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    refuse(name + " is not a finite number");
  }
  return value.get<double>();
}

template <std::size_t N>
std::array<double, N> numbers(const Json& view, const char* name) {
  const auto found = view.find(name);
  if (found == view.end() || !found->is_array() || found->size() != N) {
    refuse(std::string(name) + " is not a list of " + std::to_string(N) + " numbers");
  }
  std::array<double, N> out{};
  for (std::size_t i = 0; i < N; ++i) {
    out[i] = finite_number((*found)[i], name);
  }
  return out;
}

depth::Intrinsics read_intrinsics(const Json& view) {
  const std::array<double, 9> k = numbers<9>(view, "cam_K");
  const bool pinhole = k[1] == 0.0 && k[3] == 0.0 && k[6] == 0.0 && k[7] == 0.0 && k[8] == 1.0;
  if (!(k[0] > 0.0) || !(k[4] > 0.0) || !pinhole) {
    refuse("cam_K is not the matrix of a pinhole camera (fx 0 cx, 0 fy cy, 0 0 1)");
  }
  return {0, 0, k[0], k[4], k[2], k[5]};
}

std::optional<RigidTransform> read_camera_pose(const Json& view) {
  if (!view.contains("cam_R_w2c") && !view.contains("cam_t_w2c")) {
    return std::nullopt;
  }
  const std::array<double, 9> r = numbers<9>(view, "cam_R_w2c");
  const std::array<double, 3> t = numbers<3>(view, "cam_t_w2c");
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(r.data());
  const auto T_camera_base = geometry::rigid_from_parts(rotation, {t[0], t[1], t[2]});
  if (!T_camera_base.ok()) {
    refuse("cam_R_w2c is not a rotation");
  }
  return T_camera_base.value().inverse();
}

std::optional<RigidTransform> read_flange_pose(const Json& view) {
  if (!view.contains("T_base_flange")) {
    return std::nullopt;
  }
  const std::array<double, 16> m = numbers<16>(view, "T_base_flange");
  const auto T_base_flange = geometry::rigid_from_row_major(m);
  if (!T_base_flange.ok()) {
    refuse("T_base_flange is not a rigid transform");
  }
  return T_base_flange.value();
}

std::optional<std::int64_t> read_stamp(const Json& view) {
  const auto found = view.find("stamp_ns");
  if (found == view.end()) {
    return std::nullopt;
  }
  if (!found->is_number_integer()) {
    refuse("stamp_ns is not a whole number");
  }
  return found->get<std::int64_t>();
}

ViewCamera read_view(const Json& view) {
  if (!view.is_object()) {
    refuse("is not an object");
  }
  ViewCamera camera;
  camera.intrinsics = read_intrinsics(view);
  camera.mm_per_count =
      view.contains("depth_scale") ? finite_number(view["depth_scale"], "depth_scale") : 0.0;
  if (!(camera.mm_per_count > 0.0)) {
    refuse("depth_scale is missing or not above zero");
  }
  camera.T_base_camera = read_camera_pose(view);
  camera.T_base_flange = read_flange_pose(view);
  camera.stamp_ns = read_stamp(view);
  return camera;
}

std::uint32_t read_id(const std::string& key) {
  constexpr std::uint32_t kLargest = 999'999;  // Six digits in the images' names.
  std::uint32_t id = 0;
  const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), id);
  if (error != std::errc() || end != key.data() + key.size() || id > kLargest) {
    refuse("view \"" + key + "\" is not a number from 0 to 999999");
  }
  return id;
}

std::vector<ViewCamera> read_all(std::string_view text) {
  const Json root = Json::parse(text);
  if (!root.is_object() || root.empty() || root.size() > kMaxViewsInSet) {
    refuse("does not hold 1 to " + std::to_string(kMaxViewsInSet) + " views");
  }
  std::vector<ViewCamera> cameras;
  for (const auto& [key, view] : root.items()) {
    const std::uint32_t id = read_id(key);
    try {
      cameras.push_back(read_view(view));
    } catch (const std::runtime_error& error) {
      refuse("view " + key + ": " + error.what());
    }
    cameras.back().id = id;
  }
  std::ranges::sort(cameras, {}, &ViewCamera::id);
  return cameras;
}

}  // namespace

Loaded<std::vector<ViewCamera>> parse_scene_camera(std::string_view text,
                                                   const std::filesystem::path& file) {
  try {
    return read_all(text);
  } catch (const std::exception& error) {
    return LoadFault{file.string() + ": " + error.what()};
  }
}

}  // namespace dseam::hal::replay
