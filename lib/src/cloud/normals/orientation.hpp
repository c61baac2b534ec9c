// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "dseam/cloud/cloud.hpp"

namespace dseam::cloud {

/// Turns good normals towards the sensor; returns how many have none to turn to.
std::uint32_t orient(const FusedCloudView& cloud, std::span<const geometry::Vec3f> sensors,
                     NormalsBuffer& normals) noexcept;

}  // namespace dseam::cloud
