// SPDX-License-Identifier: Apache-2.0
#include "page/page.hpp"

#include <cmath>
#include <numbers>

#include "page/page_charts.hpp"
#include "page/page_style.hpp"
#include "page/page_tables.hpp"
#include "page/seam_picture.hpp"
#include "report/text.hpp"

namespace dseam::program {
namespace {

std::string degrees(double angle_rad) {
  return fixed(angle_rad * 180.0 / std::numbers::pi, 1) + "°";
}

std::string tile(const std::string& value, const std::string& meaning) {
  return "<div class=\"tile\"><b>" + value + "</b><span>" + meaning + "</span></div>\n";
}

std::string verdict(const JobReport& job) {
  return "<div class=\"verdict" + std::string(job.weld ? " good" : "") + "\"><b>" +
         (job.weld ? "Accepted" : "Refused") + "</b>" + escaped(job.reason) + "</div>\n" +
         (job.fault.empty() ? ""
                            : "<div class=\"verdict\"><b>Not welded to the end</b>" +
                                  escaped(job.fault) + "</div>\n") +
         warnings_list(job.warnings);
}

/// The largest part of most budgets, which the sigmas among the views do not hold.
std::string base_tile(const std::vector<BudgetRow>& budget) {
  return budget.empty()
             ? ""
             : tile(fixed(total_sigma_mm(budget), 2) + " mm", "sigma in the robot's base");
}

std::string gap_tile(const seam::JointReport& joint) {
  if (joint.has_gap) {
    return tile(fixed(joint.mean_gap_mm, 2) + " mm", "gap (mean)");
  }
  return joint.hidden_gap_mm > 0.0 ? tile("&le; " + fixed(joint.hidden_gap_mm, 2) + " mm",
                                          "gap, if any: its edge was not seen")
                                   : tile("none", "gap");
}

std::string tiles(const JobReport& job) {
  const seam::SeamReport& report = job.seam_report;
  const seam::SeamQuality& quality = report.quality;
  if (job.seam_base.points.empty()) {
    return "";
  }
  std::string out = "<div class=\"tiles\">\n";
  out += tile(fixed(report.length_mm, 1) + " mm", "length of the seam");
  out += tile(fixed(100.0 * quality.coverage, 1) + " %", "of it measured");
  out += tile(degrees(quality.largest_hole_rad), "largest hole");
  out += tile(fixed(quality.mean_sigma_lateral_mm, 3) + " mm", "sigma across the seam");
  out += tile(fixed(quality.mean_sigma_normal_mm, 3) + " mm", "sigma off the shell");
  out += base_tile(job.budget) + gap_tile(report.joint);
  out += tile(degrees(report.joint.axes_angle_rad), "between the axes");
  return out + "</div>\n";
}

std::string pictures(const JobReport& job) {
  if (job.cloud_base.points.size() == 0) {
    return "";
  }
  std::string out = "<h2>Scan and seam</h2>\n<div class=\"pictures\">\n";
  const auto drawn = seam_pictures(job);
  for (const std::size_t i : {1U, 0U, 2U}) {
    out +=
        "<figure>" + drawn[i].svg + "<figcaption>" + drawn[i].caption + "</figcaption></figure>\n";
  }
  out +=
      "</div>\n<p class=\"soft key\"><i style=\"border-color:#00b894\"></i>seam, measured"
      "<i style=\"border-color:#e84393;border-top-style:dashed\"></i>bridged"
      "<i style=\"border-color:#00b894;border-top-style:dotted\"></i>behind something";
  return out +
         (job.path.empty() ? ""
                           : "<i style=\"border-color:#2d3436;border-top-style:dashed\">"
                             "</i>torch without arc") +
         ". Blue: shell. Orange: nozzle. The ring marks the start.</p>\n";
}

}  // namespace

std::string page(const JobReport& job) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">"
      "<title>dseam " +
      escaped(job.command) + "</title><style>" + kPageStyle +
      "</style></head><body><main>\n<header><h1>dseam " + escaped(job.command) +
      "</h1><span class=\"soft\">" + escaped(job.input) + "</span></header>\n";
  out += verdict(job) + tiles(job) + pictures(job) + charts(job);
  out += budget_table(job.budget) + stage_table(job.stages) + view_table(job.views);
  out += ring_table(job.seam_report) + robot_table(job.robot);
  return out + "</main></body></html>\n";
}

}  // namespace dseam::program
