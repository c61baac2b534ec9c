// SPDX-License-Identifier: Apache-2.0
#include "dseam/markers/blob_finder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "dseam/base/random.hpp"
#include "support/arena_owner.hpp"

namespace dseam::markers {
namespace {

constexpr int kHalfWindow = 6;
constexpr int kContrast = 10;

struct Image {
  int width;
  int height;
  std::vector<std::uint8_t> gray;

  [[nodiscard]] int at(int u, int v) const {
    return gray[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(u)];
  }
  /// 1 where the pixel is lighter than the mean of its window in the image, -1 where it is darker.
  [[nodiscard]] int sign_at(int u, int v) const {
    int sum = 0;
    int n = 0;
    for (int y = std::max(0, v - kHalfWindow); y <= std::min(height - 1, v + kHalfWindow); ++y) {
      for (int x = std::max(0, u - kHalfWindow); x <= std::min(width - 1, u + kHalfWindow); ++x) {
        sum += at(x, y);
        ++n;
      }
    }
    const int difference = at(u, v) * n - sum;
    return (difference > kContrast * n ? 1 : 0) - (difference < -kContrast * n ? 1 : 0);
  }
};

Image patches(int width, int height, std::uint64_t seed) {
  Image image{width, height, {}};
  Pcg32 random(seed);
  image.gray.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 120);
  for (int i = 0; i < width * height / 20; ++i) {
    const auto at = random.below(static_cast<std::uint32_t>(image.gray.size() - 3));
    std::fill_n(image.gray.begin() + at, 3, static_cast<std::uint8_t>(random.below(256)));
  }
  return image;
}

/// Pixels, and sums of where they are.
struct Sums {
  std::uint64_t area = 0;
  std::uint64_t u = 0;
  std::uint64_t v = 0;
  std::uint64_t uv = 0;

  friend bool operator==(const Sums&, const Sums&) = default;
};

Sums expected(const Image& image, int sign) {
  Sums sums;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      if (image.sign_at(u, v) == sign) {
        ++sums.area;
        sums.u += static_cast<std::uint64_t>(u);
        sums.v += static_cast<std::uint64_t>(v);
        sums.uv += static_cast<std::uint64_t>(u * v);
      }
    }
  }
  return sums;
}

Sums found(std::span<const Blob> blobs, Polarity polarity) {
  Sums sums;
  for (std::uint32_t i = 0; i < blobs.size(); ++i) {
    if (blobs[i].parent == i && blobs[i].polarity == polarity) {
      sums.area += blobs[i].area_px;
      sums.u += blobs[i].sum_u;
      sums.v += blobs[i].sum_v;
      sums.uv += blobs[i].sum_uv;
    }
  }
  return sums;
}

TEST(BlobFinder, takes_the_pixels_off_the_mean_of_their_window_whatever_the_width) {
  for (const int width : {8, 9, 13, 14, 20, 31, 64, 101}) {
    const Image image = patches(width, 40, static_cast<std::uint64_t>(width));
    test::ArenaOwner memory(BlobFinder::bytes(static_cast<std::uint32_t>(width)));
    BlobFinder finder = BlobFinder::make({kHalfWindow, kContrast},
                                         static_cast<std::uint32_t>(width), memory.arena())
                            .value();

    const BlobFinder::Report report = finder.run(image.gray);

    EXPECT_EQ(report.lost, 0U);
    EXPECT_EQ(found(finder.blobs(), Polarity::kLightOnDark), expected(image, 1)) << width;
    EXPECT_EQ(found(finder.blobs(), Polarity::kDarkOnLight), expected(image, -1)) << width;
  }
}

}  // namespace
}  // namespace dseam::markers
