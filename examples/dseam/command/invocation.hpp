// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "config/settings.hpp"
#include "failure.hpp"

namespace dseam::program {

/// What every command is told.
struct Invocation {
  std::filesystem::path config_file;
  std::vector<std::string> assignments;  ///< --set section.name=value
  std::string unit = "mm";
  std::string reference;  ///< Empty: as configured.
  std::string method;     ///< Empty: as configured.
  std::string seam;       ///< Closed or open; empty: as configured.

  /// Millimetres in one unit of the clouds read.
  [[nodiscard]] double mm_per_unit() const { return unit == "m" ? 1000.0 : 1.0; }
  /// The defaults, then the file, then --set and the options.
  void configure(Settings& settings) const;
};

}  // namespace dseam::program
