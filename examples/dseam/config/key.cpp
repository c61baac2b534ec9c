// SPDX-License-Identifier: Apache-2.0
#include "config/key.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdio>
#include <string_view>

namespace dseam::program {
namespace {

/// The shortest text that reads back as the same number; always a TOML float.
template <std::floating_point T>
std::string number_text(T value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  std::string number(text.data(), end);
  return number.find_first_of(".en") == std::string::npos ? number + ".0" : number;
}

std::string bound_text(double bound) {
  std::array<char, 32> text{};
  const int size = std::snprintf(text.data(), text.size(), "%.6g", bound);
  return {text.data(), static_cast<std::size_t>(size)};
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
  }
  return text;
}

std::string series_text(const Series& series) {
  const auto item = [&series](std::size_t i) {
    const double value = series.get(i);
    return series.whole ? std::to_string(std::llround(value)) : number_text(value);
  };
  const std::size_t told = series.told();
  std::string text = item(0);
  for (std::size_t i = 1; i < told; ++i) {
    text += ", " + item(i);
  }
  return told == 1 ? text : '[' + text + ']';
}

struct ValueText {
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const std::string* value) const { return '"' + *value + '"'; }
  std::string operator()(const Choice& value) const { return '"' + value.names[value.get()] + '"'; }
  std::string operator()(const Series& value) const { return series_text(value); }
  template <std::unsigned_integral T>
  std::string operator()(const T* value) const {
    return std::to_string(*value);
  }
  template <std::floating_point T>
  std::string operator()(const T* value) const {
    return number_text(*value);
  }
};

struct NumberOf {
  std::optional<double> operator()(const bool*) const { return std::nullopt; }
  std::optional<double> operator()(const std::string*) const { return std::nullopt; }
  std::optional<double> operator()(const Choice&) const { return std::nullopt; }
  std::optional<double> operator()(const Series&) const { return std::nullopt; }
  template <typename T>
  std::optional<double> operator()(const T* value) const {
    return static_cast<double>(*value);
  }
};

std::string bounds_text(const Key& key) {
  const bool has_min = std::isfinite(key.min);
  const bool has_max = std::isfinite(key.max);
  std::string text;
  if (has_min && has_max) {
    text = bound_text(key.min) + " to " + bound_text(key.max);
  } else if (has_min) {
    text = "at least " + bound_text(key.min);
  } else if (has_max) {
    text = "at most " + bound_text(key.max);
  } else {
    text = "any number";
  }
  return key.unit.empty() ? text : text + " " + key.unit;
}

}  // namespace

std::size_t Series::told() const {
  std::size_t count = size;
  while (count > 1 && get(count - 1) == get(count - 2)) {
    --count;
  }
  return count;
}

std::optional<double> number(const Key& key) { return std::visit(NumberOf{}, key.field); }

std::string value_text(const Key& key) { return std::visit(ValueText{}, key.field); }

std::string range_text(const Key& key) {
  if (const auto* named = std::get_if<Choice>(&key.field)) {
    return joined(named->names);
  }
  if (std::holds_alternative<bool*>(key.field)) {
    return "true or false";
  }
  if (std::holds_alternative<std::string*>(key.field)) {
    return "a text";
  }
  if (const auto* series = std::get_if<Series>(&key.field)) {
    return bounds_text(key) + ", or a list of up to " + std::to_string(series->size);
  }
  return bounds_text(key);
}

}  // namespace dseam::program
