// SPDX-License-Identifier: Apache-2.0
#include "job/extract_job.hpp"

#include <algorithm>

#include "dseam/pipeline/open_seam_chain.hpp"
#include "failure.hpp"
#include "report/curve_report.hpp"
#include "report/verdict.hpp"

namespace dseam::program {
namespace {

constexpr std::size_t kLeastCapacity = 1024;

StageRow rim_row(const pipeline::PaperPipeline::Report& report, double ms) {
  return {"passthrough, outliers, voxels, normals, boundary",
          ms,
          {{"inside the passthrough", report.passthrough.kept},
           {"not outliers", report.outliers.kept},
           {"voxels", report.voxels.cells},
           {"good normals", report.normals.good},
           {"boundary points", report.boundary.boundary},
           {"inside the constraints", report.constrained}}};
}

}  // namespace

ExtractJob::ExtractJob(const Settings& settings, const LoadedCloud& cloud, Stopwatch& watch,
                       JobReport& job)
    : points_(settings.max_seam_points) {
  job.cloud_base.points = cloud.view();
  if (settings.method == Method::kPaper) {
    by_paper(settings, cloud, watch, job);
  } else if (settings.shape == SeamShape::kOpen) {
    by_chain<pipeline::OpenSeamChain>(settings, cloud, watch, job);
  } else {
    by_chain<pipeline::SeamChain>(settings, cloud, watch, job);
  }
  job.weld = job.seam_report.weld();
}

template <typename Chain>
void ExtractJob::by_chain(const Settings& settings, const LoadedCloud& cloud, Stopwatch& watch,
                          JobReport& job) {
  const typename Chain::Capacity capacity{.max_points = std::max(kLeastCapacity, cloud.size())};
  memory_ = std::make_unique<LentMemory>(Chain::bytes(capacity));
  auto chain = Chain::make(settings.seam, capacity, memory_->arena());
  if (!chain.ok()) {
    throw Failure(ExitCode::kUsage,
                  std::string("the configured seam stage: ") + name(chain.error()));
  }
  Buffer<seam::SeamPoint> seam(points_);
  job.seam_report = chain.value().run({.cloud_base = job.cloud_base,
                                       .region = settings.ring.region(),
                                       .expected_radius_mm = settings.ring.radius_mm()},
                                      seam);
  job.stages.push_back({"seam", watch.lap_ms(), {{"points", static_cast<double>(seam.size())}}});
  job.seam_base = view_of(seam.view(), job.seam_report);
  job.reason = reason_of(job.seam_report, settings.seam);
}

void ExtractJob::by_paper(const Settings& settings, const LoadedCloud& cloud, Stopwatch& watch,
                          JobReport& job) {
  const std::size_t max_points = std::max(kLeastCapacity, cloud.size());
  memory_ = std::make_unique<LentMemory>(pipeline::PaperPipeline::bytes(max_points));
  pipeline::PaperPipeline::Config config = settings.paper;
  config.point_spacing_mm = settings.seam.point_spacing_mm;
  config.min_coverage = settings.seam.min_coverage;
  auto chain = pipeline::PaperPipeline::make(config, max_points, memory_->arena());
  if (!chain.ok()) {
    throw Failure(ExitCode::kUsage,
                  std::string("the configured paper's chain: ") + name(chain.error()));
  }
  Buffer<seam::SeamPoint> seam(points_);
  const auto report = chain.value().run(cloud.view(), seam);
  job.method = "paper";
  job.stages.push_back(rim_row(report, watch.lap_ms()));
  job.stages.push_back(curve_row(report.curve, 0.0));
  job.seam_report = seam_report_of(report.curve);
  job.seam_report.refusal = report.refusal;
  job.seam_base = view_of(seam.view(), job.seam_report);
  job.reason = paper_reason_of(report, config);
}

}  // namespace dseam::program
