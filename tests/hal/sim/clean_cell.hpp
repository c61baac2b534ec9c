// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/hal/sim/cell.hpp"

namespace dseam::hal::sim {

/// Without any error but those that a test turns on.
inline CellConfig clean_cell() {
  CellConfig config;
  config.scanner.noise_mm = 0.0;
  config.scanner.bowl_mm = 0.0;
  config.scanner.dropout_share = 0.0;
  config.scanner.flying_share = 0.0;
  config.scanner.gray_noise = 0.0;
  config.scanner.width = 648;
  config.scanner.height = 483;
  return config;
}

inline Rendering scan(const CellConfig& config, std::size_t view = 0) {
  Rendering out;
  Cell::make(config).value().scan(view, out);
  return out;
}

}  // namespace dseam::hal::sim
