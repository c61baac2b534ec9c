// SPDX-License-Identifier: Apache-2.0
#include "scan/pose/marker_stations.hpp"

#include <string>

#include "dseam/hal/replay/scan_set.hpp"
#include "dseam/pipeline/splice_chain.hpp"
#include "failure.hpp"
#include "job/lent_memory.hpp"

namespace dseam::program {
namespace {

std::vector<depth::DepthImage> images_of(const hal::replay::ScanSet& scan,
                                         const std::filesystem::path& set) {
  if (scan.views.size() > cloud::kMaxViews) {
    throw Failure(ExitCode::kInput, set.string() + ": " + std::to_string(scan.views.size()) +
                                        " views; at most " + std::to_string(cloud::kMaxViews));
  }
  std::vector<depth::DepthImage> images;
  for (const hal::replay::ScanView& view : scan.views) {
    if (!view.camera.T_base_flange) {
      throw Failure(ExitCode::kInput, set.string() + ": view " + std::to_string(view.camera.id) +
                                          " has no T_base_flange");
    }
    images.push_back(view.image());
  }
  return images;
}

std::vector<splice::SplicedView> splice_unaided(const std::vector<depth::DepthImage>& images) {
  pipeline::SpliceChain::Capacity capacity;
  capacity.max_views = images.size();
  capacity.width = images.front().intrinsics.width;
  capacity.height = images.front().intrinsics.height;
  LentMemory memory(pipeline::SpliceChain::bytes(capacity));
  auto chain = pipeline::SpliceChain::make({}, capacity, memory.arena());
  if (!chain.ok()) {
    throw Failure(ExitCode::kUsage, std::string("the splice stage: ") + name(chain.error()));
  }
  std::vector<splice::SplicedView> storage(images.size());
  Buffer<splice::SplicedView> views(storage);
  (void)chain.value().run(images, {}, views);
  storage.resize(views.size());
  return storage;
}

}  // namespace

std::vector<calibration::PosePair> read_stations(const std::filesystem::path& set) {
  const auto scan = hal::replay::read_scan_set(set);
  if (!scan.ok()) {
    throw Failure(ExitCode::kInput, scan.fault());
  }
  const std::vector<depth::DepthImage> images = images_of(scan.value(), set);
  std::vector<calibration::PosePair> pairs;
  if (images.empty()) {
    return pairs;
  }
  const std::vector<splice::SplicedView> views = splice_unaided(images);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].state == splice::ViewState::kUsed) {
      pairs.push_back(
          {*scan.value().views[i].camera.T_base_flange, views[i].T_base_camera.inverse()});
    }
  }
  return pairs;
}

}  // namespace dseam::program
