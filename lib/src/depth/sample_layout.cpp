// SPDX-License-Identifier: Apache-2.0
#include "dseam/depth/sample_layout.hpp"

#include <array>
#include <cstddef>

namespace dseam::depth {
namespace {

struct Code {
  std::uint32_t code;
  SampleFormat format;
};

/// Source:  the PFNC value list (EMVA), 3D section, and Mono16.
constexpr std::array<Code, 9> kPfnc{{
    {0x011000B8, SampleFormat::kC16},
    {0x01100007, SampleFormat::kC16},  // Mono16
    {0x012000BF, SampleFormat::kC32f},
    {0x022000BB, SampleFormat::kAC16},
    {0x022000BC, SampleFormat::kAC16Planar},
    {0x023000B9, SampleFormat::kABC16},
    {0x023000BA, SampleFormat::kABC16Planar},
    {0x026000C0, SampleFormat::kABC32f},
    {0x026000C1, SampleFormat::kABC32fPlanar},
}};

constexpr std::array<Code, 2> kFourcc{{
    {fourcc('Z', '1', '6', ' '), SampleFormat::kC16},
    {fourcc('Y', '1', '6', ' '), SampleFormat::kC16},
}};

template <std::size_t N>
Result<SampleFormat> find(const std::array<Code, N>& table, std::uint32_t code) noexcept {
  for (const Code& entry : table) {
    if (entry.code == code) {
      return entry.format;
    }
  }
  return Errc::kUnsupported;
}

}  // namespace

SampleLayout layout_of(SampleFormat format) noexcept {
  constexpr std::array<SampleLayout, 8> kLayouts{{
      {1, 2, false},  // C16
      {1, 4, false},  // C32f
      {2, 2, false},  // AC16
      {2, 2, true},   // AC16_Planar
      {3, 2, false},  // ABC16
      {3, 2, true},   // ABC16_Planar
      {3, 4, false},  // ABC32f
      {3, 4, true},   // ABC32f_Planar
  }};
  return kLayouts[static_cast<std::size_t>(format) % kLayouts.size()];
}

std::uint64_t row_bytes(const DepthModel& model) noexcept {
  const std::uint64_t tight =
      std::uint64_t{model.intrinsics.width} * layout_of(model.format).pixel_bytes();
  return model.row_stride_bytes == 0 ? tight : model.row_stride_bytes;
}

std::uint64_t depth_bytes(const DepthModel& model) noexcept {
  const SampleLayout layout = layout_of(model.format);
  const std::uint64_t planes = layout.planar ? layout.samples : 1U;
  const std::uint64_t rows = planes * model.intrinsics.height;
  return rows == 0 ? 0
                   : (rows - 1) * row_bytes(model) +
                         std::uint64_t{model.intrinsics.width} * layout.pixel_bytes();
}

std::uint64_t gray_bytes(const DepthModel& model) noexcept {
  const std::uint64_t width = model.intrinsics.width;
  const std::uint64_t stride =
      model.gray_row_stride_bytes == 0 ? width : model.gray_row_stride_bytes;
  return model.has_gray && model.intrinsics.height > 0
             ? (model.intrinsics.height - 1) * stride + width
             : 0;
}

Result<SampleFormat> format_from_pfnc(std::uint32_t code) noexcept { return find(kPfnc, code); }

Result<SampleFormat> format_from_fourcc(std::uint32_t code) noexcept { return find(kFourcc, code); }

}  // namespace dseam::depth
