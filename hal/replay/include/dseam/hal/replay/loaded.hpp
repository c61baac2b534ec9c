// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <variant>

namespace dseam::hal::replay {

/// One line for people: which file, and what is wrong with it.
struct LoadFault {
  std::string text;
};

/// A T read from a file, or the one line that says why there is none.
template <typename T>
class [[nodiscard]] Loaded {
 public:
  Loaded(T value) : state_(std::move(value)) {}          // NOLINT(google-explicit-constructor)
  Loaded(LoadFault fault) : state_(std::move(fault)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const noexcept { return state_.index() == 0; }
  [[nodiscard]] T& value() { return std::get<0>(state_); }
  [[nodiscard]] const T& value() const { return std::get<0>(state_); }
  [[nodiscard]] const std::string& fault() const { return std::get<1>(state_).text; }

 private:
  std::variant<T, LoadFault> state_;
};

}  // namespace dseam::hal::replay
