// SPDX-License-Identifier: Apache-2.0
#include "page/page_charts.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "page/svg_chart.hpp"
#include "report/loop_profile.hpp"

namespace dseam::program {
namespace {

constexpr const char* kShellColour = "#4a7ba6";
constexpr const char* kNozzleColour = "#c07a2b";
constexpr double kReachMm = 12.0;  // How far from the seam a surface still matters to it.
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();  // Interrupts a line.

std::string figure(const Chart& chart, const std::string& caption) {
  return "<figure>" + svg(chart) + "<figcaption>" + caption + "</figcaption></figure>\n";
}

std::vector<std::pair<double, double>> bridged_stretches(const seam::SeamView& seam_base) {
  std::vector<std::pair<double, double>> stretches;
  for (std::size_t i = 0; i < seam_base.points.size(); ++i) {
    if (seam_base.points[i].source == seam::Source::kMeasured) {
      continue;
    }
    const double from = seam_base.points[i].s_mm;
    const double to =
        i + 1 < seam_base.points.size() ? seam_base.points[i + 1].s_mm : seam_base.length_mm;
    if (!stretches.empty() && stretches.back().second >= from - 1e-9) {
      stretches.back().second = to;
    } else {
      stretches.emplace_back(from, to);
    }
  }
  return stretches;
}

Chart loop_chart(const seam::SeamView& seam_base, const std::string& y_label) {
  Chart chart;
  chart.x_label = "along the seam, mm from its start";
  chart.y_label = y_label;
  chart.x_max = seam_base.length_mm;
  chart.shaded = bridged_stretches(seam_base);
  return chart;
}

ChartSeries along_seam(const seam::SeamView& seam_base, const std::string& label,
                       const std::string& colour,
                       const std::function<double(const seam::SeamPoint&)>& value) {
  ChartSeries series{label, colour, {}, {}};
  for (const seam::SeamPoint& point : seam_base.points) {
    series.line.emplace_back(point.s_mm, value(point));
  }
  return series;
}

ChartSeries series_of(const SurfaceProfile& profile, const std::string& label,
                      const std::string& colour) {
  ChartSeries series{label, colour, {}, profile.spread_mm};
  for (std::size_t i = 0; i < profile.s_mm.size(); ++i) {
    series.line.emplace_back(profile.s_mm[i], profile.mean_mm[i]);
  }
  return series;
}

Chart residual_chart(const JobReport& job) {
  const LoopProfile profile =
      loop_profile(job.cloud_base.points, job.seam_base, job.seam_report.joint, kReachMm);
  Chart chart = loop_chart(job.seam_base, "residual, mm");
  chart.series = {series_of(profile.shell, "shell", kShellColour),
                  series_of(profile.nozzle, "nozzle", kNozzleColour)};
  return chart;
}

Chart sigma_chart(const seam::SeamView& seam_base) {
  Chart chart = loop_chart(seam_base, "one standard deviation, mm");
  chart.from_zero = true;
  chart.series = {along_seam(seam_base, "across the seam", "#00876c",
                             [](const seam::SeamPoint& p) { return p.sigma_lateral_mm; }),
                  along_seam(seam_base, "off the shell", "#8e44ad",
                             [](const seam::SeamPoint& p) { return p.sigma_normal_mm; })};
  return chart;
}

Chart dihedral_chart(const seam::SeamView& seam_base) {
  Chart chart = loop_chart(seam_base, "degrees");
  chart.series = {along_seam(seam_base, "dihedral angle", "#2c3e50", [](const auto& p) {
    return p.dihedral_rad * 180.0 / std::numbers::pi;
  })};
  return chart;
}

Chart gap_chart(const seam::SeamView& seam_base) {
  Chart chart = loop_chart(seam_base, "mm");
  chart.from_zero = true;
  chart.series = {along_seam(seam_base, "gap", "#c0392b", [](const auto& p) { return p.gap_mm; })};
  return chart;
}

Chart speed_chart(trajectory::SetPointView path) {
  Chart chart;
  chart.x_label = "time, s";
  chart.y_label = "torch speed, mm/s";
  chart.x_max = 1e-6 * path.back().t_us;
  chart.from_zero = true;
  ChartSeries burning{"arc on", "#e67e22", {}, {}};
  ChartSeries moving{"arc off", "#7f8c8d", {}, {}};
  const std::size_t stride = std::max<std::size_t>(1, path.size() / 2000);
  for (std::size_t i = 0; i < path.size(); i += stride) {
    const double t_s = 1e-6 * path[i].t_us;
    burning.line.emplace_back(t_s, path[i].arc ? path[i].speed_mm_s : kNan);
    moving.line.emplace_back(t_s, path[i].arc ? kNan : path[i].speed_mm_s);
  }
  chart.series = {moving, burning};
  return chart;
}

}  // namespace

std::string charts(const JobReport& job) {
  if (job.seam_base.points.empty() || !(job.seam_base.length_mm > 0.0)) {
    return "";
  }
  std::string out = "<h2>Around the loop</h2>\n<div class=\"charts\">\n";
  out += figure(residual_chart(job),
                "Measured points within 12 mm of the seam, minus the fitted surface: mean and one "
                "standard deviation");
  out += figure(sigma_chart(job.seam_base), "How well the seam's position is known");
  out += figure(dihedral_chart(job.seam_base), "Angle between the surfaces, on the weld side");
  if (job.seam_report.joint.has_gap) {
    out += figure(gap_chart(job.seam_base), "Between the shell's edge and the nozzle");
  }
  if (!job.path.empty() && job.path.back().t_us > 0) {
    out += figure(speed_chart(job.path), "Speed of the torch along the path");
  }
  return out + "</div>\n<p class=\"soft\">Pink: not measured, bridged by the model.</p>\n";
}

}  // namespace dseam::program
