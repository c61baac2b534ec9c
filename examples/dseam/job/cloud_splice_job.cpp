// SPDX-License-Identifier: Apache-2.0
#include "job/cloud_splice_job.hpp"

#include <algorithm>

#include "dseam/pipeline/cloud_splice_chain.hpp"
#include "failure.hpp"
#include "input/cloud_reader.hpp"
#include "job/lent_memory.hpp"
#include "job/stopwatch.hpp"

namespace dseam::program {
namespace {

StageRow row_of(const std::filesystem::path& file, const pipeline::CloudSpliceRow& row) {
  return {file.filename().string(),
          0.0,
          {{"agreement", row.agreement},
           {"best rival's share", row.rival},
           {"overlap", row.overlap},
           {"rms mm", row.rms_mm},
           {"motions not shown", row.num_frozen}}};
}

}  // namespace

CloudSpliceJob::CloudSpliceJob(const std::vector<std::filesystem::path>& files, double mm_per_unit)
    : files_(files), views_(cloud::kMaxViews) {
  if (files.size() > cloud::kMaxViews) {
    throw Failure(ExitCode::kInput, std::to_string(files.size()) + " clouds; at most " +
                                        std::to_string(cloud::kMaxViews));
  }
  for (const std::filesystem::path& file : files) {
    clouds_.push_back(read_cloud(file, mm_per_unit));
  }
}

std::size_t CloudSpliceJob::run(JobReport& job) {
  Stopwatch watch;
  const pipeline::CloudSpliceChain::Capacity capacity;
  LentMemory memory(pipeline::CloudSpliceChain::bytes(capacity));
  auto chain = pipeline::CloudSpliceChain::make({}, capacity, memory.arena());
  if (!chain.ok()) {
    throw Failure(ExitCode::kDefect, std::string("splicing clouds: ") + name(chain.error()));
  }
  std::vector<cloud::CloudView> clouds;
  std::transform(clouds_.begin(), clouds_.end(), std::back_inserter(clouds),
                 [](const LoadedCloud& cloud) { return cloud.view(); });
  Buffer<splice::SplicedView> views(views_);
  const std::size_t placed = chain.value().run(clouds, views);
  views_.resize(views.size());
  job.stages.push_back({"splice", watch.lap_ms(), {{"clouds", double(placed)}}});
  for (std::size_t i = 0; i < views_.size(); ++i) {
    job.stages.push_back(row_of(files_[i], chain.value().rows()[i]));
  }
  merge();
  job.views = views_;
  job.cloud_base = {merged_.view(), count_, seen_by_};
  return placed;
}

void CloudSpliceJob::merge() {
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const bool used = views_[i].state == splice::ViewState::kUsed;
    for (std::size_t k = 0; used && k < clouds_[i].size(); ++k) {
      const Eigen::Vector3d p(clouds_[i].x[k], clouds_[i].y[k], clouds_[i].z[k]);
      const Eigen::Vector3d q = views_[i].T_base_camera * p;
      merged_.add(q.x(), q.y(), q.z());
      count_.push_back(1);
      seen_by_.push_back(static_cast<cloud::ViewMask>(1U << i));
    }
  }
}

}  // namespace dseam::program
