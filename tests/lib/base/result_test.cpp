// SPDX-License-Identifier: Apache-2.0
#include "dseam/base/result.hpp"

#include <gtest/gtest.h>

namespace dseam {
namespace {

TEST(Result, holds_a_value_or_the_reason_why_there_is_none) {
  const Result<int> good = 7;
  const Result<int> bad = Errc::kTimeout;

  EXPECT_TRUE(good.ok());
  EXPECT_EQ(good.value(), 7);
  EXPECT_FALSE(bad.ok());
  EXPECT_EQ(bad.error(), Errc::kTimeout);
  EXPECT_STREQ(name(bad.error()), "Timeout");
}

TEST(ResultDeathTest, the_value_of_a_failure_is_a_broken_precondition) {
  Result<int> bad = Errc::kIo;

  EXPECT_DEATH((void)bad.value(), "");
}

}  // namespace
}  // namespace dseam
