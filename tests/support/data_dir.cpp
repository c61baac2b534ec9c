// SPDX-License-Identifier: Apache-2.0
#include "support/data_dir.hpp"

#include <cstdlib>

namespace dseam::test {

std::filesystem::path data_dir() {
  const char* named = std::getenv("DSEAM_DATA_DIR");
  return named != nullptr ? named : DSEAM_DEFAULT_DATA_DIR;
}

}  // namespace dseam::test
