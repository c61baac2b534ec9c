// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "support/data_dir.hpp"

namespace dseam::test {

/// A suite that reads measured data. They are not part of the project: a clone without them says
/// so and goes on, a machine that proves the project (CI set) does not accept it.
class MeasuredData : public testing::Test {
 protected:
  void SetUp() override {
    if (std::filesystem::exists(data_dir() / "paper_weld_points.csv")) {
      return;
    }
    ASSERT_EQ(std::getenv("CI"), nullptr) << "no measured data in " << data_dir();
    GTEST_SKIP() << "no measured data in " << data_dir() << ": set DSEAM_DATA_DIR";
  }
};

}  // namespace dseam::test
