// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace dseam::program {

struct ChartSeries {
  std::string label;
  std::string colour;
  std::vector<std::pair<double, double>> line;  ///< A NaN value interrupts it.
  std::vector<double> half_band;                ///< Drawn about the line, or empty.
};

/// A line chart as one inline SVG.
struct Chart {
  std::string x_label;
  std::string y_label;
  double x_max = 1.0;
  std::vector<ChartSeries> series;
  std::vector<std::pair<double, double>> shaded;  ///< Stretches of x without measurement.
  bool from_zero = false;                         ///< The y axis includes 0.
};

[[nodiscard]] std::string svg(const Chart& chart);

}  // namespace dseam::program
