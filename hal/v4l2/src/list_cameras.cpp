// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <vector>

#include "dseam/depth/sample_layout.hpp"
#include "video_stream.hpp"

namespace dseam::hal::v4l2 {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> video_nodes() {
  std::vector<std::string> nodes;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/dev", ignored)) {
    if (entry.path().filename().string().starts_with("video")) {
      nodes.push_back(entry.path().string());
    }
  }
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

/// The name of a node that stays the same after a replug, or the node itself.
std::string stable_name(const std::string& node) {
  for (const char* folder : {"/dev/v4l/by-id", "/dev/v4l/by-path"}) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      if (fs::weakly_canonical(entry.path(), ignored) == node) {
        return entry.path().string();
      }
    }
  }
  return node;
}

/// Opens as the camera would, with either depth format.
void probe(V4l2Sys& sys, CameraInfo& camera) {
  for (const std::uint32_t code :
       {depth::fourcc('Z', '1', '6', ' '), depth::fourcc('Y', '1', '6', ' ')}) {
    V4l2Config config;
    config.device = camera.id;
    config.fourcc = code;
    VideoStream stream(sys);
    const auto opened = stream.open(config, camera.why_not);
    camera.model = stream.grant().card;
    camera.address = stream.grant().bus_info;
    if (opened.ok()) {
      camera.why_not.clear();
      return;
    }
    if (opened.error() != Errc::kUnsupported) {
      return;
    }
  }
}

}  // namespace

std::vector<CameraInfo> list_cameras(V4l2Sys& sys) {
  std::vector<CameraInfo> cameras;
  for (const std::string& node : video_nodes()) {
    CameraInfo camera{
        .backend = "v4l2", .id = stable_name(node), .model = {}, .address = {}, .why_not = {}};
    probe(sys, camera);
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

}  // namespace dseam::hal::v4l2
