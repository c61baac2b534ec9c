// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <stdexcept>

#include "input/cloud_reader.hpp"
#include "input/scalar_layout.hpp"

namespace dseam::program {
namespace {

/// One column off the front of a line, without blanks about it.
std::string_view take_column(std::string_view& line) {
  const std::size_t end = std::min(line.find(','), line.size());
  std::string_view column = line.substr(0, end);
  line.remove_prefix(std::min(end + 1, line.size()));
  column.remove_prefix(std::min(column.find_first_not_of(" \t"), column.size()));
  return column.substr(0, column.find_last_not_of(" \t") + 1);
}

std::optional<std::array<double, 3>> point_of(std::string_view line) {
  std::array<double, 3> p{};
  for (double& coordinate : p) {
    const std::optional<double> value = number(take_column(line));
    if (!value) {
      return std::nullopt;
    }
    coordinate = *value;
  }
  return p;
}

}  // namespace

LoadedCloud parse_csv(const std::string& bytes, double mm_per_unit) {
  std::string_view text(bytes);
  LoadedCloud cloud;
  std::size_t line_number = 0;
  for (auto line = take_line(text); line; line = take_line(text)) {
    ++line_number;
    const auto p = point_of(*line);
    if (p) {
      cloud.add(mm_per_unit * (*p)[0], mm_per_unit * (*p)[1], mm_per_unit * (*p)[2]);
    } else if (line_number > 1 && !line->empty()) {  // The first may be a header.
      throw std::runtime_error("line " + std::to_string(line_number) +
                               ": three numbers expected: '" + std::string(line->substr(0, 60)) +
                               "'");
    }
    if (cloud.size() > kMaxCloudPoints) {
      throw std::runtime_error("too many points");
    }
  }
  return cloud;
}

}  // namespace dseam::program
