// SPDX-License-Identifier: Apache-2.0
#include "command/invocation.hpp"

#include "config/load.hpp"

namespace dseam::program {

void Invocation::configure(Settings& settings) const {
  std::vector<Key> keys = keys_of(settings);
  if (!config_file.empty()) {
    load_config(config_file, keys);
  }
  for (const std::string& assignment : assignments) {
    set_key(assignment, keys);
  }
  if (!reference.empty()) {
    set_key("seam.reference = \"" + reference + '"', keys);
  }
  if (!method.empty()) {
    set_key("job.method = \"" + method + '"', keys);
  }
  if (!seam.empty()) {
    set_key("seam.kind = \"" + seam + '"', keys);
  }
  check_together(settings, keys);
}

}  // namespace dseam::program
