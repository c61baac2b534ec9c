// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <stdexcept>

#include "input/cloud_reader.hpp"
#include "input/scalar_layout.hpp"

namespace dseam::program {
namespace {

ScalarType type_of(std::string_view name) {
  struct Named {
    std::string_view a;
    std::string_view b;
    ScalarType type;
  };
  constexpr std::array<Named, 8> kTypes{{{"char", "int8", ScalarType::kInt8},
                                         {"uchar", "uint8", ScalarType::kUint8},
                                         {"short", "int16", ScalarType::kInt16},
                                         {"ushort", "uint16", ScalarType::kUint16},
                                         {"int", "int32", ScalarType::kInt32},
                                         {"uint", "uint32", ScalarType::kUint32},
                                         {"float", "float32", ScalarType::kFloat32},
                                         {"double", "float64", ScalarType::kFloat64}}};
  for (const Named& named : kTypes) {
    if (name == named.a || name == named.b) {
      return named.type;
    }
  }
  throw std::runtime_error("header: unknown type '" + std::string(name) + "'");
}

void set_format(std::string_view name, PointLayout& layout) {
  if (name != "ascii" && name != "binary_little_endian" && name != "binary_big_endian") {
    throw std::runtime_error("header: unknown format '" + std::string(name) + "'");
  }
  layout.binary = name != "ascii";
  layout.big_endian = name == "binary_big_endian";
}

/// Reads the header; leaves `text` at the first vertex.
class Header {
 public:
  PointLayout read(std::string_view& text) {
    for (auto line = take_line(text); line; line = take_line(text)) {
      if (*line == "end_header") {
        return finished();
      }
      take(*line);
    }
    throw std::runtime_error("truncated: the header does not end");
  }

 private:
  void take(std::string_view line) {
    const std::string_view keyword = take_word(line);
    if (keyword == "format") {
      set_format(take_word(line), layout_);
      has_format_ = true;
    } else if (keyword == "element") {
      const std::string_view name = take_word(line);
      begin_element(name, take_word(line));
    } else if (keyword == "property" && in_vertex_) {
      const std::string_view type = take_word(line);
      if (type == "list") {
        throw std::runtime_error("header: a vertex with a list is not supported");
      }
      layout_.fields.push_back({std::string(take_word(line)), type_of(type), 1});
    }
  }

  void begin_element(std::string_view name, std::string_view count) {
    in_vertex_ = name == "vertex";
    if (in_vertex_) {
      layout_.num_points = count_of(count, "element vertex");
      has_vertex_ = true;
    } else if (!has_vertex_ && count_of(count, "element") > 0) {
      throw std::runtime_error("header: the vertices must come first");
    }
  }

  PointLayout finished() const {
    if (!has_format_ || !has_vertex_) {
      throw std::runtime_error("header: no format or no element vertex");
    }
    return layout_;
  }

  PointLayout layout_;
  bool has_format_ = false;
  bool has_vertex_ = false;
  bool in_vertex_ = false;
};

}  // namespace

LoadedCloud parse_ply(const std::string& bytes, double mm_per_unit) {
  std::string_view text(bytes);
  const PointLayout layout = Header().read(text);
  return read_points(layout, text, mm_per_unit);
}

}  // namespace dseam::program
