// SPDX-License-Identifier: Apache-2.0
#include "input/json_reader.hpp"

#include <algorithm>
#include <array>

#include "failure.hpp"
#include "input/cloud_reader.hpp"

namespace dseam::program {
namespace {

constexpr int kMaxDepth = 32;  // What writes a value again calls itself for each level.

[[noreturn]] void fail(const std::string& where, const std::string& fault) {
  throw Failure(ExitCode::kInput, where + ": " + fault);
}

/// The numbers of an array, or of its arrays.
void collect(const nlohmann::json& node, std::vector<double>& numbers) {
  for (const nlohmann::json& item : node) {
    if (item.is_array() && !item.empty() && item.front().is_number()) {
      collect(item, numbers);
    } else {
      numbers.push_back(item.is_number() ? item.get<double>()
                                         : std::numeric_limits<double>::quiet_NaN());
    }
  }
}

}  // namespace

nlohmann::json parse_json(const std::string& bytes, const std::string& name) {
  const auto not_too_deep = [&name](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    return depth <= kMaxDepth ? true : (fail(name, "nested too deeply"), false);
  };
  try {
    return nlohmann::json::parse(bytes, not_too_deep);
  } catch (const nlohmann::json::parse_error& error) {
    const std::size_t offset = std::min(bytes.size(), error.byte);
    const auto line =
        1 + std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(offset), '\n');
    fail(name + ":" + std::to_string(line), bytes.empty() ? "empty" : "not JSON, or truncated");
  } catch (const nlohmann::json::out_of_range&) {
    fail(name, "a number is too large");
  }
}

nlohmann::json read_json(const std::filesystem::path& file) {
  return parse_json(read_bytes(file), file.string());
}

geometry::RigidTransform rigid_at(const nlohmann::json& object, const char* key,
                                  const std::string& where) {
  if (!object.is_object() || !object.contains(key)) {
    fail(where, std::string("no ") + key);
  }
  std::vector<double> numbers;
  if (object[key].is_array()) {
    collect(object[key], numbers);
  }
  if (numbers.size() != 16) {
    fail(where, std::string(key) + " is not 16 numbers");
  }
  const auto rigid = geometry::rigid_from_row_major(std::span<const double, 16>(numbers));
  if (!rigid.ok()) {
    fail(where, std::string(key) +
                    " is not a rigid transform (finite, orthonormal, right-handed, "
                    "last row 0 0 0 1)");
  }
  return rigid.value();
}

}  // namespace dseam::program
