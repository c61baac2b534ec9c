// SPDX-License-Identifier: Apache-2.0
#include "dseam/base/buffer.hpp"

#include <gtest/gtest.h>

#include <array>

namespace dseam {
namespace {

TEST(Buffer, a_full_buffer_refuses_and_keeps_what_it_has) {
  std::array<int, 2> storage{};
  Buffer<int> buffer(storage);

  EXPECT_TRUE(buffer.append(1));
  EXPECT_TRUE(buffer.append(2));
  EXPECT_FALSE(buffer.append(3));

  EXPECT_TRUE(buffer.full());
  EXPECT_EQ(buffer.view()[1], 2);
}

TEST(Buffer, a_cleared_buffer_is_empty_and_can_be_filled_again) {
  std::array<int, 1> storage{};
  Buffer<int> buffer(storage);
  EXPECT_TRUE(buffer.append(1));

  buffer.clear();

  EXPECT_TRUE(buffer.empty());
  EXPECT_TRUE(buffer.append(2));
}

}  // namespace
}  // namespace dseam
