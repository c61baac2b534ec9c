// SPDX-License-Identifier: Apache-2.0
#include "input/scalar_layout.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "input/cloud_reader.hpp"

namespace dseam::program {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kMaxFieldCount = 4096;  // Histograms of descriptors have some hundreds.

template <typename T>
double load(const char* bytes, bool big_endian) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (big_endian) {
    std::reverse(raw.begin(), raw.end());
  }
  return static_cast<double>(std::bit_cast<T>(raw));
}

/// Where x, y and z stand among the numbers of a point.
struct Axis {
  std::size_t column = 0;  ///< Ascii: which word.
  std::size_t offset = 0;  ///< Binary: which byte.
  ScalarType type = ScalarType::kFloat32;
};

std::optional<Axis> find_axis(const PointLayout& layout, std::string_view name) {
  Axis axis;
  for (const PointLayout::Field& field : layout.fields) {
    if (field.name == name) {
      axis.type = field.type;
      return axis;
    }
    axis.column += field.count;
    axis.offset += field.count * size_of(field.type);
  }
  return std::nullopt;
}

std::array<Axis, 3> axes_of(const PointLayout& layout) {
  return {find_axis(layout, "x").value(), find_axis(layout, "y").value(),
          find_axis(layout, "z").value()};
}

[[noreturn]] void fail_truncated(const PointLayout& layout, std::size_t found) {
  throw std::runtime_error("truncated: " + std::to_string(layout.num_points) +
                           " points announced, " + std::to_string(found) + " found");
}

LoadedCloud read_binary(const PointLayout& layout, std::string_view data, double mm_per_unit) {
  std::size_t stride = 0;
  for (const PointLayout::Field& field : layout.fields) {
    stride += field.count * size_of(field.type);
  }
  if (data.size() / stride < layout.num_points) {
    fail_truncated(layout, data.size() / stride);
  }
  const std::array<Axis, 3> axes = axes_of(layout);
  LoadedCloud cloud;
  for (std::size_t i = 0; i < layout.num_points; ++i) {
    const auto at = [&](const Axis& axis) {
      const char* bytes = data.data() + i * stride + axis.offset;
      return mm_per_unit * scalar_at(bytes, axis.type, layout.big_endian);
    };
    cloud.add(at(axes[0]), at(axes[1]), at(axes[2]));
  }
  return cloud;
}

std::array<double, 3> read_row(std::string_view line, const std::array<Axis, 3>& axes,
                               std::size_t row) {
  std::array<double, 3> p{};
  std::size_t found = 0;
  std::size_t column = 0;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line), ++column) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (axes[k].column != column) {
        continue;
      }
      const std::optional<double> value = number(word);
      if (!value) {
        throw std::runtime_error("point " + std::to_string(row) + ": '" + std::string(word) +
                                 "' is not a number");
      }
      p[k] = *value;
      ++found;
    }
  }
  if (found < 3) {
    throw std::runtime_error("point " + std::to_string(row) + ": too few numbers");
  }
  return p;
}

LoadedCloud read_ascii(const PointLayout& layout, std::string_view data, double mm_per_unit) {
  const std::array<Axis, 3> axes = axes_of(layout);
  LoadedCloud cloud;
  for (std::size_t i = 0; i < layout.num_points; ++i) {
    const std::optional<std::string_view> line = take_line(data);
    if (!line) {
      fail_truncated(layout, i);
    }
    const std::array<double, 3> p = read_row(*line, axes, i);
    cloud.add(mm_per_unit * p[0], mm_per_unit * p[1], mm_per_unit * p[2]);
  }
  return cloud;
}

}  // namespace

std::size_t size_of(ScalarType type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

double scalar_at(const char* bytes, ScalarType type, bool big_endian) {
  switch (type) {
    case ScalarType::kInt8:
      return load<std::int8_t>(bytes, big_endian);
    case ScalarType::kUint8:
      return load<std::uint8_t>(bytes, big_endian);
    case ScalarType::kInt16:
      return load<std::int16_t>(bytes, big_endian);
    case ScalarType::kUint16:
      return load<std::uint16_t>(bytes, big_endian);
    case ScalarType::kInt32:
      return load<std::int32_t>(bytes, big_endian);
    case ScalarType::kUint32:
      return load<std::uint32_t>(bytes, big_endian);
    case ScalarType::kFloat32:
      return load<float>(bytes, big_endian);
    case ScalarType::kFloat64:
      return load<double>(bytes, big_endian);
  }
  return 0.0;
}

void PointLayout::check() const {
  for (const char* axis : {"x", "y", "z"}) {
    if (!find_axis(*this, axis)) {
      throw std::runtime_error(std::string("has no field '") + axis + "'");
    }
  }
  for (const Field& field : fields) {
    if (field.count == 0 || field.count > kMaxFieldCount) {
      throw std::runtime_error("header: field '" + field.name + "' has no sensible count");
    }
  }
  if (num_points > kMaxCloudPoints) {
    throw std::runtime_error("too many points: " + std::to_string(num_points) + ", at most " +
                             std::to_string(kMaxCloudPoints));
  }
}

LoadedCloud read_points(const PointLayout& layout, std::string_view data, double mm_per_unit) {
  layout.check();
  return layout.binary ? read_binary(layout, data, mm_per_unit)
                       : read_ascii(layout, data, mm_per_unit);
}

std::optional<std::string_view> take_line(std::string_view& text) {
  if (text.empty()) {
    return std::nullopt;
  }
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) {
    line.remove_suffix(1);
  }
  return line;
}

std::string_view take_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(" \t"));
  line.remove_prefix(word.size());
  return word;
}

std::optional<double> number(std::string_view word) {
  double value = 0.0;
  word.remove_prefix(word.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = end == word.data() + word.size();
  return error == std::errc{} && whole ? std::optional(value) : std::nullopt;
}

std::size_t count_of(std::string_view word, const char* what) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) {
    throw std::runtime_error(std::string("header: ") + what + " is not a count: '" +
                             std::string(word) + "'");
  }
  return value;
}

}  // namespace dseam::program
