// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "dseam/depth/depth_image.hpp"
#include "dseam/markers/marker.hpp"

namespace dseam::pipeline {

/// Marks the pixels that marker discs and their blurred rims cover with 1, all others with 0:
/// a disc is a sticker on the part, not its surface.
void mask_markers(std::span<const markers::Marker> markers, const depth::Intrinsics& intrinsics,
                  std::span<std::uint8_t> mask) noexcept;

}  // namespace dseam::pipeline
