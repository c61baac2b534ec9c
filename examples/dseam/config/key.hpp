// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace dseam::program {

/// One of several named values. Bound to an enumeration by choice().
struct Choice {
  std::vector<std::string> names;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};

/// A number for each of several things of a kind, such as the passes. The file gives a list, whose
/// last number holds for all that follow, or one number for all of them.
struct Series {
  std::size_t size;  ///< The longest list.
  bool whole;        ///< No fractions.
  std::function<double(std::size_t)> get;
  std::function<void(std::size_t, double)> set;
  const std::uint8_t* in_use;  ///< How many there are.

  /// How many numbers say it all.
  [[nodiscard]] std::size_t told() const;
};

/// Where the value of a key lives: in the very struct that a stage is made from, so that its
/// default is the stage's own and stands nowhere twice.
using Field = std::variant<bool*, double*, float*, std::uint8_t*, std::uint16_t*, std::uint32_t*,
                           std::uint64_t*, std::string*, Choice, Series>;

/// One key of the configuration file: the only place that knows its name, range and meaning.
struct Key {
  std::string section;
  std::string name;
  Field field;
  std::string comment;
  std::string unit = {};
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::string set_at = {};  ///< The line that set it, as messages show it; empty: the default.

  [[nodiscard]] std::string path() const { return section + "." + name; }
};

/// A choice over an enumeration whose values count from zero in the order of `names`.
template <typename Enum>
Choice choice(Enum& value, std::vector<std::string> names) {
  return {std::move(names), [&value] { return static_cast<std::size_t>(value); },
          [&value](std::size_t i) { value = static_cast<Enum>(i); }};
}

/// One member of each item, of which `in_use` count; `place` finds it: a pointer to the member, or
/// a function that returns a reference.
template <typename Item, std::size_t kSize, typename Place>
Series series(std::array<Item, kSize>& items, const std::uint8_t& in_use, Place place) {
  using Number = std::remove_cvref_t<std::invoke_result_t<Place, Item&>>;
  return {
      kSize, std::is_integral_v<Number>,
      [&items, place](std::size_t i) { return static_cast<double>(std::invoke(place, items[i])); },
      [&items, place](std::size_t i, double value) {
        std::invoke(place, items[i]) = static_cast<Number>(value);
      },
      &in_use};
}

/// The key's value where that is a single number.
[[nodiscard]] std::optional<double> number(const Key& key);
/// The key's value as TOML writes it.
[[nodiscard]] std::string value_text(const Key& key);
/// What the key allows, for people: "0.2 to 10 mm", "true or false", "a or b".
[[nodiscard]] std::string range_text(const Key& key);

}  // namespace dseam::program
