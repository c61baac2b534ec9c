// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "dseam/cloud/cloud.hpp"

namespace dseam::program {

/// Binary little-endian PLY: x, y, z in mm, and where the cloud is fused `count` and `views`.
void write_ply(const cloud::FusedCloudView& cloud_base, std::ostream& out);

}  // namespace dseam::program
