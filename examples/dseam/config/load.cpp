// SPDX-License-Identifier: Apache-2.0
#include "config/load.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <ostream>
#include <sstream>
#include <utility>

#include "failure.hpp"

#define TOML_EXCEPTIONS 1
// Some of its assertions fail on bad input (a NUL as a key) that it names properly without them.
#define TOML_ASSERT(condition) static_cast<void>(0)
#include <toml++/toml.h>

namespace dseam::program {
namespace {

/// Each fault found, a line each, so that a file is repaired in one go.
class Faults {
 public:
  explicit Faults(std::string file) : file_(std::move(file)) {}

  void add(const toml::node& at, const std::string& what) { add(at.source().begin.line, what); }
  void add(std::size_t line, const std::string& what) {
    by_line_.emplace(line, place(line) + ": " + what);
  }
  [[nodiscard]] std::string place(std::size_t line) const {
    return file_ + ":" + std::to_string(line);
  }
  void throw_if_any() const {
    std::string text;
    for (const auto& [line, fault] : by_line_) {
      text += (text.empty() ? "" : "\n") + fault;
    }
    if (!text.empty()) {
      throw Failure(ExitCode::kUsage, text);
    }
  }

 private:
  std::string file_;
  std::multimap<std::size_t, std::string> by_line_;
};

/// Assigns a TOML node to the field it visits; false when the type or the range is wrong.
class Assign {
 public:
  Assign(const toml::node& node, const Key& key) : node_(node), key_(key) {}

  bool operator()(bool* field) const { return take(field, node_.value_exact<bool>()); }
  bool operator()(std::string* field) const {
    return take(field, node_.value_exact<std::string>());
  }
  bool operator()(const Choice& field) const {
    const auto name = node_.value_exact<std::string>();
    const auto found = std::find(field.names.begin(), field.names.end(), name.value_or(""));
    if (!name || found == field.names.end()) {
      return false;
    }
    field.set(static_cast<std::size_t>(found - field.names.begin()));
    return true;
  }
  template <std::unsigned_integral T>
  bool operator()(T* field) const {
    const auto whole = node_.value_exact<std::int64_t>();
    const auto value = static_cast<double>(whole.value_or(-1));
    if (!whole || !std::in_range<T>(*whole) || value < key_.min || value > key_.max) {
      return false;
    }
    *field = static_cast<T>(*whole);
    return true;
  }
  template <std::floating_point T>
  bool operator()(T* field) const {
    const double value = number_in(node_);
    if (!in_range(value)) {
      return false;
    }
    *field = static_cast<T>(value);
    return true;
  }
  bool operator()(const Series& field) const {
    const toml::array* list = node_.as_array();
    const std::size_t given = list == nullptr ? 1 : list->size();
    if (given == 0 || given > field.size) {
      return false;
    }
    for (std::size_t i = 0; i < field.size; ++i) {
      const toml::node& item = list == nullptr ? node_ : (*list)[std::min(i, given - 1)];
      const double value = number_in(item);
      if (!in_range(value) || (field.whole && !item.is_integer())) {
        return false;
      }
      field.set(i, value);
    }
    return true;
  }

 private:
  template <typename T>
  static bool take(T* field, std::optional<T> value) {
    if (value) {
      *field = *std::move(value);
    }
    return value.has_value();
  }
  /// NaN where it is none.
  static double number_in(const toml::node& node) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const bool number = node.is_floating_point() || node.is_integer();
    return number ? node.value<double>().value_or(kNan) : kNan;
  }
  // A float's own default may lie half a digit outside a bound that is exact in double.
  [[nodiscard]] bool in_range(double value) const {
    const double slack = 1e-6 * std::abs(value);
    return std::isfinite(value) && value >= key_.min - slack && value <= key_.max + slack;
  }

  const toml::node& node_;
  const Key& key_;
};

std::string shown(const toml::node& node) {
  std::ostringstream text;
  node.visit([&text](const auto& value) { text << value; });
  return text.str();
}

Key* find(std::vector<Key>& keys, std::string_view section, std::string_view name) {
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const Key& key) {
    return key.section == section && key.name == name;
  });
  return found == keys.end() ? nullptr : &*found;
}

void apply_section(std::string_view section, const toml::table& table, std::vector<Key>& keys,
                   Faults& faults) {
  for (const auto& [name, node] : table) {
    Key* key = find(keys, section, name.str());
    if (key == nullptr) {
      faults.add(node,
                 "unknown key '" + std::string(section) + "." + std::string(name.str()) + "'");
    } else if (!std::visit(Assign(node, *key), key->field)) {
      faults.add(node, "'" + key->path() + "' cannot be " + shown(node) +
                           "; allowed: " + range_text(*key));
    } else {
      key->set_at = faults.place(node.source().begin.line);
    }
  }
}

void apply(const toml::table& root, std::vector<Key>& keys, Faults& faults) {
  for (const auto& [name, node] : root) {
    const bool known =
        std::any_of(keys.begin(), keys.end(),
                    [section = name.str()](const Key& key) { return key.section == section; });
    if (!known) {
      faults.add(node, "unknown section or key '" + std::string(name.str()) + "'");
    } else if (!node.is_table()) {
      faults.add(node, "'" + std::string(name.str()) + "' is a section, not a value");
    } else {
      apply_section(name.str(), *node.as_table(), keys, faults);
    }
  }
  faults.throw_if_any();
}

toml::table parsed(const std::string& name, const std::function<toml::table()>& parse) {
  try {
    return parse();
  } catch (const toml::parse_error& error) {
    Faults faults(name);
    faults.add(error.source().begin.line, std::string(error.description()));
    faults.throw_if_any();
    throw;
  }
}

/// `name=word` as a shell leaves it of `name="word"`.
std::string with_quotes(const std::string& assignment) {
  const std::size_t value = assignment.find('=') + 1;
  return value == 0 ? assignment
                    : assignment.substr(0, value) + '"' + assignment.substr(value) + '"';
}

}  // namespace

void load_config(const std::filesystem::path& file, std::vector<Key>& keys) {
  Faults faults(file.string());
  if (!std::filesystem::is_regular_file(file)) {
    throw Failure(ExitCode::kUsage, file.string() + ": no such configuration file");
  }
  apply(parsed(file.string(), [&] { return toml::parse_file(file.string()); }), keys, faults);
}

void set_key(const std::string& assignment, std::vector<Key>& keys) {
  Faults faults("--set " + assignment);
  const auto parse = [&assignment] {
    try {
      return toml::parse(assignment);
    } catch (const toml::parse_error&) {
      return toml::parse(with_quotes(assignment));
    }
  };
  apply(parsed("--set " + assignment, parse), keys, faults);
}

void print_config(const std::vector<Key>& keys, std::ostream& out) {
  std::string section;
  for (const Key& key : keys) {
    if (key.section != section) {
      out << (section.empty() ? "" : "\n") << '[' << key.section << "]\n";
      section = key.section;
    }
    out << "# " << key.comment << " [" << range_text(key) << "]\n"
        << key.name << " = " << value_text(key) << '\n';
  }
}

}  // namespace dseam::program
