// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "config/load.hpp"
#include "config/settings.hpp"
#include "failure.hpp"

/// A configuration is refused with its lines, or what was taken prints as one that is taken again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  dseam::program::Settings settings;
  auto keys = dseam::program::keys_of(settings);
  try {
    dseam::program::set_key(text, keys);
  } catch (const dseam::program::Failure&) {
    return 0;
  }
  std::ostringstream printed;
  dseam::program::print_config(keys, printed);
  try {
    dseam::program::set_key(printed.str(), keys);
  } catch (const dseam::program::Failure&) {
    std::abort();
  }
  return 0;
}
