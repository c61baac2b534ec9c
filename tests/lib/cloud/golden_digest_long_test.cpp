// SPDX-License-Identifier: Apache-2.0
// The same bits from large clouds: 56 of 100,000 points and more, four of each family.
#include <gtest/gtest.h>

#include "stage_digest.hpp"

namespace dseam::cloud {
namespace {

// In the order of the families.
constexpr std::uint64_t kLarge[test::kNumFamilies] = {
    0xD3F4D58E28D22B7DULL, 0xDD41C487A8CE1FFBULL, 0x59343C9E19E33783ULL, 0x7F1865F8F57067E2ULL,
    0x5A77E54EE2B9A834ULL, 0xAEA101B6193813FCULL, 0xE45E39F87ADA7018ULL, 0x1CF162F193363F1DULL,
    0x87549C59F67EA17DULL, 0x9D0DA1BAF9E19899ULL, 0x9249643656F19B8FULL, 0xFA622C6F2771A80FULL,
    0xD2A4DEACA3F20791ULL, 0x78E58D42B3D5BC9DULL};

TEST(GoldenDigestLong, every_stage_gives_the_recorded_bits_from_large_clouds) {
  for (int family = 0; family < test::kNumFamilies; ++family) {
    const auto its = static_cast<test::Family>(family);
    EXPECT_EQ(digest_of_family(its, 4, 100000), kLarge[family]) << test::name(its);
  }
}

}  // namespace
}  // namespace dseam::cloud
