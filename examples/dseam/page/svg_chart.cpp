// SPDX-License-Identifier: Apache-2.0
#include "page/svg_chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "report/text.hpp"

namespace dseam::program {
namespace {

constexpr double kWidth = 760.0;
constexpr double kHeight = 240.0;
constexpr double kLeft = 62.0;
constexpr double kRight = 14.0;
constexpr double kTop = 30.0;
constexpr double kBottom = 42.0;

struct Axis {
  double min;
  double max;
  double step;
};

/// The largest of 1, 2, 5 times a power of ten that divides the span into about `parts`.
double tick_step(double span, double parts) {
  const double rough = span / parts;
  const double magnitude = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * magnitude >= rough) {
      return factor * magnitude;
    }
  }
  return 10.0 * magnitude;
}

Axis y_axis(const Chart& chart) {
  double low = chart.from_zero ? 0.0 : std::numeric_limits<double>::infinity();
  double high = chart.from_zero ? 0.0 : -std::numeric_limits<double>::infinity();
  for (const ChartSeries& series : chart.series) {
    for (std::size_t i = 0; i < series.line.size(); ++i) {
      const double band = i < series.half_band.size() ? series.half_band[i] : 0.0;
      if (std::isfinite(series.line[i].second + band)) {
        low = std::min(low, series.line[i].second - band);
        high = std::max(high, series.line[i].second + band);
      }
    }
  }
  if (!(high > low)) {
    low = std::isfinite(low) ? low - 0.5 : 0.0;
    high = low + 1.0;
  }
  const double step = tick_step(high - low, 5.0);
  return {std::floor(low / step + 1e-9) * step, std::ceil(high / step - 1e-9) * step, step};
}

class Plot {
 public:
  Plot(const Chart& chart, const Axis& y) : chart_(chart), y_(y) {}

  std::string text() {
    shade();
    grid();
    for (const ChartSeries& series : chart_.series) {
      band(series);
      line(series);
    }
    legend();
    return "<svg class=\"chart\" viewBox=\"0 0 760 240\" role=\"img\">" + svg_ + "</svg>\n";
  }

 private:
  [[nodiscard]] double px(double x) const {
    return kLeft + (kWidth - kLeft - kRight) * x / chart_.x_max;
  }
  [[nodiscard]] double py(double y) const {
    return kTop + (kHeight - kTop - kBottom) * (y_.max - y) / (y_.max - y_.min);
  }
  [[nodiscard]] std::string at(double x, double y) const {
    return fixed(px(x), 1) + ' ' + fixed(py(y), 1);
  }

  void shade() {
    for (const auto& [from, to] : chart_.shaded) {
      svg_ += "<rect class=\"gap\" x=\"" + fixed(px(from), 1) + "\" y=\"" + fixed(kTop, 1) +
              "\" width=\"" + fixed(px(to) - px(from), 1) + "\" height=\"" +
              fixed(kHeight - kTop - kBottom, 1) + "\"/>";
    }
  }

  void grid() {
    const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(y_.step) - 1e-9)));
    for (double y = y_.min; y < y_.max + 0.5 * y_.step; y += y_.step) {
      svg_ += "<path class=\"grid\" d=\"M" + at(0, y) + 'L' + at(chart_.x_max, y) + "\"/>" +
              label(kLeft - 8, py(y) + 4, "end", fixed(y, digits));
    }
    const double step = tick_step(chart_.x_max, 10.0);
    const int x_digits = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
    for (double x = 0.0; x <= chart_.x_max + 1e-9; x += step) {
      svg_ += label(px(x), kHeight - kBottom + 16, "middle", fixed(x, x_digits));
    }
    svg_ += label(0.5 * (kLeft + kWidth - kRight), kHeight - 6, "middle", escaped(chart_.x_label));
    svg_ += label(4, 14, "start", escaped(chart_.y_label));
  }

  static std::string label(double x, double y, const char* anchor, const std::string& text) {
    return "<text x=\"" + fixed(x, 1) + "\" y=\"" + fixed(y, 1) + "\" text-anchor=\"" + anchor +
           "\">" + text + "</text>";
  }

  void line(const ChartSeries& series) {
    std::string path;
    bool pen_up = true;
    for (const auto& [x, y] : series.line) {
      if (!std::isfinite(y)) {
        pen_up = true;
        continue;
      }
      path += (pen_up ? 'M' : 'L') + at(x, y);
      pen_up = false;
    }
    svg_ += "<path class=\"line\" stroke=\"" + series.colour + "\" d=\"" + path + "\"/>";
  }

  /// One closed outline for each unbroken stretch.
  void band(const ChartSeries& series) {
    std::string upper;
    std::string lower;
    for (std::size_t i = 0; i < series.half_band.size(); ++i) {
      const auto& [x, y] = series.line[i];
      if (std::isfinite(y)) {
        upper += (upper.empty() ? 'M' : 'L') + at(x, y + series.half_band[i]);
        lower = 'L' + at(x, y - series.half_band[i]) + lower;
      }
      if ((!std::isfinite(y) || i + 1 == series.half_band.size()) && !upper.empty()) {
        svg_ +=
            "<path class=\"band\" fill=\"" + series.colour + "\" d=\"" + upper + lower + "Z\"/>";
        upper.clear();
        lower.clear();
      }
    }
  }

  void legend() {
    double x = kWidth - kRight;
    for (auto series = chart_.series.rbegin(); series != chart_.series.rend(); ++series) {
      svg_ += label(x, 14, "end", escaped(series->label));
      x -= 6.6 * static_cast<double>(series->label.size()) + 10;
      svg_ += "<path class=\"line\" stroke=\"" + series->colour + "\" d=\"M" + fixed(x - 14, 1) +
              " 10h16\"/>";
      x -= 30;
    }
  }

  const Chart& chart_;
  Axis y_;
  std::string svg_;
};

}  // namespace

std::string svg(const Chart& chart) { return Plot(chart, y_axis(chart)).text(); }

}  // namespace dseam::program
