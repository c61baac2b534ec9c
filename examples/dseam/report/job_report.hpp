// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dseam/cloud/cloud.hpp"
#include "dseam/seam/seam_report.hpp"
#include "dseam/splice/spliced_view.hpp"
#include "dseam/trajectory/set_point.hpp"

namespace dseam::program {

/// What one stage did: how long it took, and what it counted.
struct StageRow {
  std::string name;
  double ms = 0.0;
  std::vector<std::pair<std::string, double>> counts;
};

/// One part of what the seam's position is uncertain by, as one standard deviation.
struct BudgetRow {
  std::string source;
  double sigma_mm = 0.0;
  std::string basis;  ///< What the figure was taken from.
};

/// Everything that a run has to say; report.json and report.html are two writings of it.
///
/// Memory:  the spans lie in the workspace, which must outlive the report.
struct JobReport {
  std::string command;
  std::string input;
  std::string method = "dseam";
  bool weld = false;
  bool has_base = false;  ///< The frame is the robot's base, not that of the first camera.
  std::string reason;     ///< Of the verdict, for people.
  std::string fault;      ///< What ended the weld before its end; empty where nothing did.
  std::vector<std::string> warnings;
  std::vector<StageRow> stages;
  std::vector<BudgetRow> budget;
  std::span<const splice::SplicedView> views;
  cloud::FusedCloudView cloud_base;
  seam::SeamReport seam_report;
  seam::SeamView seam_base;
  trajectory::SetPointView path;
  std::vector<std::pair<std::string, std::string>> robot;  ///< What the robot's side said.
};

/// The root of the sum of squares: the parts are independent.
[[nodiscard]] double total_sigma_mm(const std::vector<BudgetRow>& budget);
[[nodiscard]] const char* name(splice::ViewState state) noexcept;

}  // namespace dseam::program
