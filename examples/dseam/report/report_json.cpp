// SPDX-License-Identifier: Apache-2.0
#include "report/report_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "files/csv_writers.hpp"
#include "report/job_report.hpp"

namespace dseam::program {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json surface_json(const seam::Surface& surface) {
  return {{"kind", seam::name(surface.kind)},
          {"point_mm", vector_json(surface.point)},
          {"axis", vector_json(surface.axis)},
          {"radius_mm", surface.radius_mm},
          {"slope", surface.slope}};
}

Json joint_json(const seam::JointReport& joint) {
  return {{"shell", surface_json(joint.shell)},
          {"nozzle", surface_json(joint.nozzle)},
          {"axes_angle_rad", joint.axes_angle_rad},
          {"axes_offset_mm", joint.axes_offset_mm},
          {"shell_harmonics", joint.shell_harmonics},
          {"nozzle_harmonics", joint.nozzle_harmonics},
          {"has_gap", joint.has_gap},
          {"mean_gap_mm", joint.mean_gap_mm},
          {"max_gap_mm", joint.max_gap_mm},
          {"hidden_gap_mm", joint.hidden_gap_mm},
          {"has_nozzle_edge", joint.has_nozzle_edge},
          {"mean_mismatch_mm", joint.mean_mismatch_mm},
          {"max_mismatch_mm", joint.max_mismatch_mm},
          {"shell_points", joint.num_shell_points},
          {"nozzle_points", joint.num_nozzle_points}};
}

Json residual_json(const seam::ResidualStats& stats) {
  return {{"rms_mm", stats.rms_mm},
          {"p95_mm", stats.p95_mm},
          {"max_mm", stats.max_mm},
          {"count", stats.count}};
}

Json quality_json(const seam::SeamQuality& quality) {
  const auto& by_confidence = quality.num_by_confidence;
  return {{"coverage", quality.coverage},
          {"largest_hole_rad", quality.largest_hole_rad},
          {"closure_mm", quality.closure_mm},
          {"lateral", residual_json(quality.lateral)},
          {"normal", residual_json(quality.normal)},
          {"mean_sigma_lateral_mm", quality.mean_sigma_lateral_mm},
          {"max_sigma_lateral_mm", quality.max_sigma_lateral_mm},
          {"mean_sigma_normal_mm", quality.mean_sigma_normal_mm},
          {"max_sigma_normal_mm", quality.max_sigma_normal_mm},
          {"points_by_confidence",
           {{"none", by_confidence[0]},
            {"low", by_confidence[1]},
            {"medium", by_confidence[2]},
            {"high", by_confidence[3]}}}};
}

Json holes_json(const seam::SeamReport& report) {
  Json holes = Json::array();
  for (std::size_t i = 0; i < std::min<std::size_t>(report.num_holes, report.holes.size()); ++i) {
    holes.push_back(
        {{"start_rad", report.holes[i].start_rad}, {"width_rad", report.holes[i].width_rad}});
  }
  return holes;
}

Json rings_json(const seam::SeamReport& report) {
  Json rings = Json::array();
  const std::size_t count = std::min<std::size_t>(report.num_candidates, report.candidates.size());
  for (std::size_t i = 0; i < count; ++i) {
    const seam::RingCandidate& ring = report.candidates[i];
    rings.push_back({{"fate", seam::name(ring.fate)},
                     {"centre_mm", vector_json(ring.centre_base)},
                     {"axis", vector_json(ring.axis_base)},
                     {"radius_mm", ring.radius_mm},
                     {"coverage", ring.coverage},
                     {"backed_length_mm", ring.score_mm}});
  }
  return rings;
}

/// Lateral and normal sigma apart, in the order of seam.csv, which has one column for both.
Json sigma_json(const seam::SeamView& seam_base) {
  Json lateral = Json::array();
  Json normal = Json::array();
  for (const seam::SeamPoint& point : seam_base.points) {
    lateral.push_back(point.sigma_lateral_mm);
    normal.push_back(point.sigma_normal_mm);
  }
  return {{"lateral_mm", lateral}, {"normal_mm", normal}};
}

/// How far the two edges that face each other are apart, in the order of seam.csv.
Json opening_json(const seam::SeamView& seam_base) {
  Json gap = Json::array();
  Json mismatch = Json::array();
  for (const seam::SeamPoint& point : seam_base.points) {
    gap.push_back(point.gap_mm);
    mismatch.push_back(point.mismatch_mm);
  }
  return {{"gap_mm", gap}, {"mismatch_mm", mismatch}};
}

Json seam_json(const JobReport& job) {
  constexpr const char* kReferences[] = {"shell_edge", "root", "gap_middle", "nozzle_edge"};
  const seam::SeamReport& report = job.seam_report;
  return {{"refusal", seam::name(report.refusal)},
          {"reference", kReferences[static_cast<std::size_t>(report.reference)]},
          {"closed", report.closed},
          {"length_mm", report.length_mm},
          {"end_sigma_mm", report.end_sigma_mm},
          {"points", job.seam_base.points.size()},
          {"cloud_points", report.num_points},
          {"cloud_points_not_finite", report.num_not_finite},
          {"cloud_spacing_mm", report.spacing_mm},
          {"cloud_noise_mm", report.noise_mm},
          {"quality", quality_json(report.quality)},
          {"holes", holes_json(report)},
          {"joint", joint_json(report.joint)},
          {"rings", rings_json(report)},
          {"opening", opening_json(job.seam_base)},
          {"sigma", sigma_json(job.seam_base)}};
}

Json stages_json(const std::vector<StageRow>& stages) {
  Json rows = Json::array();
  for (const StageRow& stage : stages) {
    Json counts = Json::object();
    for (const auto& [what, count] : stage.counts) {
      counts[what] = count;
    }
    rows.push_back({{"stage", stage.name}, {"ms", stage.ms}, {"counts", counts}});
  }
  return rows;
}

Json budget_json(const std::vector<BudgetRow>& budget) {
  Json rows = Json::array();
  for (const BudgetRow& row : budget) {
    rows.push_back({{"source", row.source}, {"sigma_mm", row.sigma_mm}, {"basis", row.basis}});
  }
  return {{"parts", rows}, {"total_sigma_mm", total_sigma_mm(budget)}};
}

}  // namespace

Json report_json(const JobReport& job) {
  Json robot = Json::object();
  for (const auto& [what, value] : job.robot) {
    robot[what] = value;
  }
  return {{"command", job.command},
          {"input", job.input},
          {"method", job.method},
          {"units", {{"length", "mm"}, {"angle", "rad"}, {"time", "ms"}}},
          {"verdict", {{"weld", job.weld}, {"reason", job.reason}}},
          {"fault", job.fault},
          {"warnings", job.warnings},
          {"stages", stages_json(job.stages)},
          {"budget", budget_json(job.budget)},
          {"seam", seam_json(job)},
          {"path_set_points", job.path.size()},
          {"robot", robot}};
}

Json poses_json(std::span<const splice::SplicedView> views) {
  Json poses = Json::object();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const splice::SplicedView& view = views[i];
    Json& pose = poses[std::to_string(i)] = {{"state", name(view.state)}};
    if (view.state != splice::ViewState::kUsed) {
      continue;  // No pose is known, and none is made up.
    }
    const std::span<const double> covariance(view.covariance.data(), 36);  // Symmetric.
    pose["T_base_camera"] = geometry::to_row_major(view.T_base_camera);
    pose["covariance_mm_rad"] = covariance;
    pose["markers"] = view.num_markers;
    pose["marker_rms_mm"] = view.marker_rms_mm;
    pose["surface_rms_mm"] = view.surface_rms_mm;
  }
  return poses;
}

}  // namespace dseam::program
