// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "dseam/depth/depth_model.hpp"
#include "dseam/hal/aravis/aravis_sys.hpp"

namespace dseam::hal::aravis {

/// Which images a frame must hold, each of the model's size.
struct WantedImages {
  depth::DepthModel model;
  bool depth = true;
  bool gray = false;
};

/// Where they lie in the buffer; empty for one that is not wanted.
struct FrameImages {
  std::span<const std::byte> depth;
  std::span<const std::byte> gray;
};

/// Picks the wanted images from the parts of a frame by their pixel format, whatever their order
/// and whatever else is sent; nothing when one is missing, too short, or of another size or stride.
[[nodiscard]] std::optional<FrameImages> pick_images(std::span<const AravisSys::Part> parts,
                                                     const WantedImages& wanted) noexcept;

}  // namespace dseam::hal::aravis
