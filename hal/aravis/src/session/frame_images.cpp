// SPDX-License-Identifier: Apache-2.0
#include "session/frame_images.hpp"

#include <arv.h>

#include "dseam/depth/sample_layout.hpp"

namespace dseam::hal::aravis {
namespace {

/// How the rows of an image follow each other, and how many bytes hold it all.
struct Shape {
  std::uint64_t pixel_bytes = 0;
  std::uint64_t row_bytes = 0;
  std::uint64_t image_bytes = 0;
};

bool is_depth(const AravisSys::Part& part, const depth::DepthModel& model) noexcept {
  const auto format = depth::format_from_pfnc(part.pixel_format);
  return format.ok() && format.value() == model.format;
}

bool is_gray(const AravisSys::Part& part) noexcept {
  return part.pixel_format == ARV_PIXEL_FORMAT_MONO_8;
}

/// The part's bytes when it is as agreed, else none.
std::span<const std::byte> image(const AravisSys::Part& part, const depth::Intrinsics& size,
                                 const Shape& shape) noexcept {
  const bool long_enough = part.size_bytes == 0 || part.size_bytes >= shape.image_bytes;
  const bool as_agreed = part.width == size.width && part.height == size.height &&
                         part.width * shape.pixel_bytes + part.row_padding_bytes == shape.row_bytes;
  return part.data != nullptr && long_enough && as_agreed ? std::span(part.data, shape.image_bytes)
                                                          : std::span<const std::byte>();
}

}  // namespace

std::optional<FrameImages> pick_images(std::span<const AravisSys::Part> parts,
                                       const WantedImages& wanted) noexcept {
  const depth::DepthModel& model = wanted.model;
  const Shape of_depth{depth::layout_of(model.format).pixel_bytes(), depth::row_bytes(model),
                       depth::depth_bytes(model)};
  const Shape of_gray{
      1, model.gray_row_stride_bytes == 0 ? model.intrinsics.width : model.gray_row_stride_bytes,
      depth::gray_bytes(model)};
  FrameImages found;
  for (const AravisSys::Part& part : parts) {
    if (wanted.depth && found.depth.empty() && is_depth(part, model)) {
      found.depth = image(part, model.intrinsics, of_depth);
    } else if (wanted.gray && found.gray.empty() && is_gray(part)) {
      found.gray = image(part, model.intrinsics, of_gray);
    }
  }
  const bool all = found.depth.empty() != wanted.depth && found.gray.empty() != wanted.gray;
  return all ? std::optional(found) : std::nullopt;
}

}  // namespace dseam::hal::aravis
