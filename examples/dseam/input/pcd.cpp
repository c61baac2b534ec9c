// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <stdexcept>
#include <utility>

#include "input/cloud_reader.hpp"
#include "input/scalar_layout.hpp"

namespace dseam::program {
namespace {

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
    words.emplace_back(word);
  }
  return words;
}

ScalarType type_of(const std::string& letter, const std::string& size) {
  constexpr std::array<std::pair<std::string_view, ScalarType>, 8> kTypes{
      {{"F4", ScalarType::kFloat32},
       {"F8", ScalarType::kFloat64},
       {"I1", ScalarType::kInt8},
       {"U1", ScalarType::kUint8},
       {"I2", ScalarType::kInt16},
       {"U2", ScalarType::kUint16},
       {"I4", ScalarType::kInt32},
       {"U4", ScalarType::kUint32}}};
  for (const auto& [name, type] : kTypes) {
    if (name == letter + size) {
      return type;
    }
  }
  throw std::runtime_error("header: unknown type " + letter + " of size " + size);
}

struct Header {
  std::vector<std::string> fields;
  std::vector<std::string> sizes;
  std::vector<std::string> types;
  std::vector<std::string> counts;
  std::string points;
  std::string data;

  /// True for the DATA line, which is the last one.
  bool take(std::string_view line) {
    const std::string_view keyword = take_word(line);
    if (keyword == "FIELDS") {
      fields = words_of(line);
    } else if (keyword == "SIZE") {
      sizes = words_of(line);
    } else if (keyword == "TYPE") {
      types = words_of(line);
    } else if (keyword == "COUNT") {
      counts = words_of(line);
    } else if (keyword == "POINTS") {
      points = take_word(line);
    } else if (keyword == "DATA") {
      data = take_word(line);
      return true;
    }
    return false;
  }

  [[nodiscard]] PointLayout layout() const {
    if (fields.empty() || sizes.size() != fields.size() || types.size() != fields.size() ||
        (!counts.empty() && counts.size() != fields.size())) {
      throw std::runtime_error("header: FIELDS, SIZE, TYPE and COUNT do not agree");
    }
    if (data != "ascii" && data != "binary") {
      throw std::runtime_error("DATA " + data + " is not supported; ascii and binary are");
    }
    PointLayout layout;
    layout.num_points = count_of(points, "POINTS");
    layout.binary = data == "binary";
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const std::size_t count = counts.empty() ? 1 : count_of(counts[i], "COUNT");
      layout.fields.push_back({fields[i], type_of(types[i], sizes[i]), count});
    }
    return layout;
  }
};

}  // namespace

LoadedCloud parse_pcd(const std::string& bytes, double mm_per_unit) {
  std::string_view text(bytes);
  Header header;
  for (auto line = take_line(text); line; line = take_line(text)) {
    if (header.take(*line)) {
      return read_points(header.layout(), text, mm_per_unit);
    }
  }
  throw std::runtime_error("truncated: the header does not end");
}

}  // namespace dseam::program
