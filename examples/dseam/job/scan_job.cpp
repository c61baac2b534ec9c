// SPDX-License-Identifier: Apache-2.0
#include "job/scan_job.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "job/stopwatch.hpp"
#include "report/job_report.hpp"
#include "report/verdict.hpp"

namespace dseam::program {
namespace {

pipeline::WeldPipeline::Capacity capacity_for(const Settings& settings,
                                              const std::vector<ScannedView>& views) {
  pipeline::WeldPipeline::Capacity capacity;
  capacity.views.max_views = views.size();
  capacity.views.width = 0;
  capacity.views.height = 0;
  for (const ScannedView& view : views) {
    capacity.views.width = std::max(capacity.views.width, view.image.intrinsics.width);
    capacity.views.height = std::max(capacity.views.height, view.image.intrinsics.height);
  }
  capacity.max_voxels = settings.max_voxels;
  capacity.seam.max_points = settings.max_voxels;
  capacity.max_seam_points = settings.max_seam_points;
  return capacity;
}

/// Milliseconds of each stage, its calls added up.
class StageTimer final : public pipeline::StageObserver {
 public:
  [[nodiscard]] double ms(pipeline::Stage stage) const {
    return ms_[static_cast<std::size_t>(stage)];
  }

 private:
  void do_ended(pipeline::Stage stage) noexcept override {
    ms_[static_cast<std::size_t>(stage)] += watch_.lap_ms();
  }

  Stopwatch watch_;
  std::array<double, pipeline::kNumStages> ms_{};
};

void add_stages(const StageTimer& timer, const pipeline::WeldReport& report, std::size_t num_views,
                JobReport& job) {
  using pipeline::Stage;
  const auto add = [&](Stage stage, std::vector<std::pair<std::string, double>> counts) {
    job.stages.push_back({pipeline::name(stage), timer.ms(stage), std::move(counts)});
  };
  const auto fused = [](const pipeline::FuseReport& fuse) {
    return std::vector<std::pair<std::string, double>>{{"cell mm", fuse.cell_mm},
                                                       {"points", fuse.points},
                                                       {"voxels", fuse.voxels},
                                                       {"dropped", fuse.dropped_full}};
  };
  add(Stage::kTakeIn, {{"views", static_cast<double>(num_views)}});
  const splice::NetworkReport& network = report.network;
  add(Stage::kAdjust, {{"iterations", network.iterations},
                       {"views used", network.num_used},
                       {"views left out", network.num_left_out},
                       {"markers", network.num_markers},
                       {"marker sights rejected", network.num_markers_rejected},
                       {"surface ties", network.num_surface_ties}});
  add(Stage::kCoarseFuse, fused(report.coarse));
  add(Stage::kCoarseSeam, {});
  add(Stage::kFineFuse, fused(report.fine));
  add(Stage::kSeam, {{"cloud points", report.seam.num_points},
                     {"surfaces", report.seam.num_surfaces},
                     {"rings", report.seam.num_candidates}});
}

/// What the seam's absolute place is uncertain by: how well it is known among the views, and how
/// well the views together are known in the base.
void add_budget(const splice::NetworkReport& network, JobReport& job) {
  if (job.seam_base.points.empty()) {
    return;
  }
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const seam::SeamPoint& point : job.seam_base.points) {
    centre += point.p_base / static_cast<double>(job.seam_base.points.size());
  }
  job.budget.push_back({"seam among the views", job.seam_report.quality.mean_sigma_lateral_mm,
                        "mean predicted sigma across the seam: scan, fit, splice and hand-eye"});
  if (network.has_base) {
    // Of three directions; one of them is across the seam.
    job.budget.push_back(
        {"base frame", splice::predicted_error_mm(network.base_covariance, centre) / std::sqrt(3.0),
         "what all views have in common: the robot's reported poses, averaged"});
  }
}

/// What became of views and poses that did not go as they should.
void add_warnings(const splice::NetworkReport& network, JobReport& job) {
  for (std::size_t i = 0; i < job.views.size(); ++i) {
    const splice::SplicedView& view = job.views[i];
    if (view.state != splice::ViewState::kUsed) {
      job.warnings.push_back("view " + std::to_string(i) + " is left out: " + name(view.state));
    }
    if (view.reported_pose_rejected) {
      job.warnings.push_back("view " + std::to_string(i) +
                             ": the robot's pose contradicts all else and was not used");
    }
  }
  if (!network.has_base && !job.views.empty()) {
    job.warnings.push_back(
        "no pose of the robot is known: all results are in the frame of the first camera");
  }
}

std::string reason_of(pipeline::ScanFault fault) {
  switch (fault) {
    case pipeline::ScanFault::kNone:
      return "";
    case pipeline::ScanFault::kNoView:
      return "no view was taken in";
    case pipeline::ScanFault::kUnspliced:
      return "no two views could be tied together: too few markers and too little overlap";
    case pipeline::ScanFault::kNotAdjusted:
      return "the views could not be adjusted to each other: the result did not settle";
    case pipeline::ScanFault::kMapFull:
      return "the part needs more voxels than the workspace has (job.max_voxels)";
  }
  return pipeline::name(fault);
}

}  // namespace

ScanJob::ScanJob(const Settings& settings, const std::vector<ScannedView>& views)
    : settings_(settings) {
  const auto capacity = capacity_for(settings, views);
  if (views.empty() || views.size() > cloud::kMaxViews) {
    throw Failure(ExitCode::kInput, std::to_string(views.size()) + " views; 1 to " +
                                        std::to_string(cloud::kMaxViews) + " are allowed");
  }
  memory_ = std::make_unique<LentMemory>(pipeline::WeldPipeline::bytes(capacity));
  pipeline::WeldPipeline::Config config = settings.pipeline;
  config.seam = settings.seam;
  config.region = settings.ring.region();
  config.expected_radius_mm = settings.ring.radius_mm();
  const auto made = pipeline::WeldPipeline::make(config, capacity, memory_->arena());
  if (!made.ok()) {
    throw Failure(ExitCode::kUsage, std::string("the configured pipeline: ") + name(made.error()));
  }
  pipeline_ = made.value();
}

ExitCode ScanJob::run(const std::vector<ScannedView>& views, JobReport& job) {
  StageTimer timer;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto taken = pipeline_->add(views[i].image, views[i].reported(), &timer);
    if (!taken.kept) {
      throw Failure(ExitCode::kInput,
                    "view " + std::to_string(i) + " cannot be used: " + name(taken.error));
    }
  }
  const pipeline::WeldReport report = pipeline_->finish(&timer);
  add_stages(timer, report, views.size(), job);
  describe(report, job);
  if (report.fault == pipeline::ScanFault::kMapFull) {
    return ExitCode::kInput;
  }
  return report.fault == pipeline::ScanFault::kNone ? exit_code_of(report.seam)
                                                    : ExitCode::kRefused;
}

void ScanJob::describe(const pipeline::WeldReport& report, JobReport& job) {
  job.views = pipeline_->views();
  job.cloud_base = pipeline_->merged();
  job.seam_report = report.seam;
  job.seam_base = view_of(pipeline_->seam_points(), report.seam);
  job.weld = report.weld();
  job.reason = report.fault == pipeline::ScanFault::kNone
                   ? program::reason_of(report.seam, settings_.seam)
                   : reason_of(report.fault);
  job.has_base = report.network.has_base;
  add_budget(report.network, job);
  add_warnings(report.network, job);
}

}  // namespace dseam::program
