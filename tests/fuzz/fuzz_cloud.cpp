// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <string>

#include "input/cloud_reader.hpp"

namespace {

using Parser = dseam::program::LoadedCloud (*)(const std::string&, double);

void check(Parser parse, const std::string& bytes) {
  try {
    const auto cloud = parse(bytes, 1.0);
    if (cloud.x.size() != cloud.y.size() || cloud.x.size() != cloud.z.size()) {
      std::abort();
    }
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!std::isfinite(cloud.x[i]) || !std::isfinite(cloud.y[i]) || !std::isfinite(cloud.z[i])) {
        std::abort();
      }
    }
  } catch (const std::exception&) {  // A named refusal.
  }
}

}  // namespace

/// Cloud and point files of each kind: refused by an exception with the fault, or read whole.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  check(dseam::program::parse_ply, bytes);
  check(dseam::program::parse_pcd, bytes);
  check(dseam::program::parse_csv, bytes);
  return 0;
}
