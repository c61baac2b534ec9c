// SPDX-License-Identifier: Apache-2.0
#include "report/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace dseam::program {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string fixed(double value, int digits) {
  std::array<char, 64> text{};
  const double cleared = std::abs(value) < 0.5 * std::pow(10.0, -digits) ? 0.0 : value;
  const int size = std::snprintf(text.data(), text.size(), "%.*f", digits, cleared);
  return {text.data(), std::min(text.size() - 1, static_cast<std::size_t>(size))};
}

}  // namespace dseam::program
