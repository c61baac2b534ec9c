// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "support/accuracy/seam_accuracy.hpp"

namespace dseam::program::test {

/// What `dseam weld` left in a folder, scored by what `--truth` left in another: nothing but the
/// files is read.
///
/// Errors:  throws std::runtime_error where a file is missing or malformed.
[[nodiscard]] dseam::test::SeamAccuracy score_weld(const std::string& out,
                                                   const std::string& truth);

}  // namespace dseam::program::test
