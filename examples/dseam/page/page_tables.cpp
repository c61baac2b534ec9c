// SPDX-License-Identifier: Apache-2.0
#include "page/page_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "report/text.hpp"

namespace dseam::program {
namespace {

/// Headings that start with '#' are those of numbers.
std::string table_start(const std::string& title, std::initializer_list<const char*> headings,
                        const std::string& meaning = "") {
  std::string out = "<h2>" + title + "</h2>\n";
  out += meaning.empty() ? "" : "<p class=\"soft\">" + meaning + "</p>\n";
  out += "<div class=\"card\"><table><tr>";
  for (const std::string heading : headings) {
    const bool number = heading.starts_with('#');
    out += (number ? "<th class=\"n\">" : "<th>") + heading.substr(number ? 1 : 0) + "</th>";
  }
  return out + "</tr>\n";
}

constexpr const char* kTableEnd = "</table></div>\n";

std::string text(const std::string& value) { return "<td>" + escaped(value) + "</td>"; }
std::string number(const std::string& value) { return "<td class=\"n\">" + value + "</td>"; }
std::string bar(double share) {
  return "<td class=\"bar\"><i style=\"width:" + fixed(100.0 * std::clamp(share, 0.0, 1.0), 1) +
         "%\"></i></td>";
}

std::string count_text(double count) {
  return std::floor(count) == count ? fixed(count, 0) : fixed(count, 3);
}

std::string spaced(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

}  // namespace

std::string warnings_list(const std::vector<std::string>& warnings) {
  std::string items;
  for (const std::string& warning : warnings) {
    items += "<li>" + escaped(warning) + "</li>";
  }
  return items.empty() ? "" : "<ul class=\"warnings\">" + items + "</ul>\n";
}

std::string budget_table(const std::vector<BudgetRow>& budget) {
  if (budget.empty()) {
    return "";
  }
  const double total = total_sigma_mm(budget);
  std::string out = table_start("Budget of errors", {"source", "#sigma, mm", "", "taken from"});
  for (const BudgetRow& row : budget) {
    out += "<tr>" + text(row.source) + number(fixed(row.sigma_mm, 3)) +
           bar(total > 0.0 ? row.sigma_mm / total : 0.0) + text(row.basis) + "</tr>\n";
  }
  return out + "<tr class=\"total\">" + text("together") + number(fixed(total, 3)) +
         "<td></td><td></td></tr>" + kTableEnd;
}

std::string stage_table(const std::vector<StageRow>& stages) {
  if (stages.empty()) {
    return "";
  }
  double longest_ms = 1e-9;
  double sum_ms = 0.0;
  for (const StageRow& stage : stages) {
    longest_ms = std::max(longest_ms, stage.ms);
    sum_ms += stage.ms;
  }
  std::string out = table_start("Stages", {"stage", "#ms", "", "counts"});
  for (const StageRow& stage : stages) {
    std::string counts;
    for (const auto& [what, count] : stage.counts) {
      counts += (counts.empty() ? "" : ", ") + what + ' ' + count_text(count);
    }
    out += "<tr>" + text(spaced(stage.name)) + number(fixed(stage.ms, 1)) +
           bar(stage.ms / longest_ms) + text(counts) + "</tr>\n";
  }
  return out + "<tr class=\"total\">" + text("together") + number(fixed(sum_ms, 1)) +
         "<td></td><td></td></tr>" + kTableEnd;
}

std::string view_table(std::span<const splice::SplicedView> views) {
  if (views.empty()) {
    return "";
  }
  std::string out = table_start("Views", {"view", "state", "#markers", "#marker rms, mm",
                                          "#surface rms, mm", "camera in base, mm"});
  for (std::size_t i = 0; i < views.size(); ++i) {
    const splice::SplicedView& view = views[i];
    const Eigen::Vector3d& t = view.T_base_camera.translation_mm;
    out += "<tr>" + text(std::to_string(i)) + text(name(view.state)) +
           number(std::to_string(view.num_markers)) + number(fixed(view.marker_rms_mm, 3)) +
           number(fixed(view.surface_rms_mm, 3)) +
           text(fixed(t.x(), 1) + ", " + fixed(t.y(), 1) + ", " + fixed(t.z(), 1)) + "</tr>\n";
  }
  return out + kTableEnd;
}

std::string ring_table(const seam::SeamReport& report) {
  const std::size_t rings = std::min<std::size_t>(report.num_candidates, report.candidates.size());
  if (rings == 0) {
    return "";
  }
  std::string out =
      table_start("Rings considered",
                  {"fate", "shell", "nozzle", "#radius, mm", "#coverage", "#backed length, mm",
                   "centre in base, mm"},
                  "Every place where two surfaces meet in a ring, and why it is the seam or not.");
  for (std::size_t i = 0; i < rings; ++i) {
    const seam::RingCandidate& ring = report.candidates[i];
    const Eigen::Vector3d& c = ring.centre_base;
    out += "<tr>" + text(seam::name(ring.fate)) + text(seam::name(ring.shell)) +
           text(seam::name(ring.nozzle)) + number(fixed(ring.radius_mm, 1)) +
           number(fixed(100.0 * ring.coverage, 1) + " %") + number(fixed(ring.score_mm, 1)) +
           text(fixed(c.x(), 1) + ", " + fixed(c.y(), 1) + ", " + fixed(c.z(), 1)) + "</tr>\n";
  }
  return out + kTableEnd;
}

std::string robot_table(const std::vector<std::pair<std::string, std::string>>& robot) {
  if (robot.empty()) {
    return "";
  }
  std::string out = table_start("Robot and link", {"", ""});
  for (const auto& [what, value] : robot) {
    out += "<tr>" + text(what) + text(value) + "</tr>\n";
  }
  return out + kTableEnd;
}

}  // namespace dseam::program
