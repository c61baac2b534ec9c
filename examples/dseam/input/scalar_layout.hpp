// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "input/loaded_cloud.hpp"

namespace dseam::program {

enum class ScalarType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

[[nodiscard]] std::size_t size_of(ScalarType type);
/// The scalar at `bytes`, swapped when the file is big endian.
[[nodiscard]] double scalar_at(const char* bytes, ScalarType type, bool big_endian);

/// How the numbers of one point follow each other in a file.
struct PointLayout {
  struct Field {
    std::string name;
    ScalarType type = ScalarType::kFloat32;
    std::size_t count = 1;
  };
  std::vector<Field> fields;
  std::size_t num_points = 0;
  bool binary = false;
  bool big_endian = false;

  /// Throws std::runtime_error when x, y or z is missing, or there are too many points.
  void check() const;
};

/// Reads all points from `data`, which starts at the first of them.
///
/// Errors:  throws std::runtime_error when it is shorter than the layout says, or not numbers.
[[nodiscard]] LoadedCloud read_points(const PointLayout& layout, std::string_view data,
                                      double mm_per_unit);

/// Takes one line off the front of `text`, without its end; none when the text is used up.
[[nodiscard]] std::optional<std::string_view> take_line(std::string_view& text);
/// Takes one word off the front of `line`; empty at its end. Words stand apart by blanks.
[[nodiscard]] std::string_view take_word(std::string_view& line);
[[nodiscard]] std::optional<double> number(std::string_view word);
/// A count of points or fields. Throws std::runtime_error when it is none.
[[nodiscard]] std::size_t count_of(std::string_view word, const char* what);

}  // namespace dseam::program
