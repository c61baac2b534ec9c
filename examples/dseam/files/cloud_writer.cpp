// SPDX-License-Identifier: Apache-2.0
#include "files/cloud_writer.hpp"

#include <bit>
#include <ostream>
#include <string>

namespace dseam::program {
namespace {

static_assert(std::endian::native == std::endian::little, "the bytes are written as they lie");

template <typename T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));  // NOLINT: raw bytes meant.
}

}  // namespace

void write_ply(const cloud::FusedCloudView& cloud_base, std::ostream& out) {
  const cloud::CloudView& points = cloud_base.points;
  const bool fused = cloud_base.count.size() == points.size() &&
                     cloud_base.seen_by.size() == points.size() && points.size() > 0;
  out << "ply\nformat binary_little_endian 1.0\ncomment frame base, unit mm\nelement vertex "
      << points.size() << "\nproperty float x\nproperty float y\nproperty float z\n"
      << (fused ? "property uint count\nproperty ushort views\n" : "") << "end_header\n";
  std::string bytes;
  bytes.reserve(points.size() * 18);
  for (std::size_t i = 0; i < points.size(); ++i) {
    append(bytes, points.x[i]);
    append(bytes, points.y[i]);
    append(bytes, points.z[i]);
    if (fused) {
      append(bytes, cloud_base.count[i]);
      append(bytes, cloud_base.seen_by[i]);
    }
  }
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace dseam::program
