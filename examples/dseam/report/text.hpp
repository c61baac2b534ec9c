// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dseam::program {

/// Text with what XML reserves escaped.
[[nodiscard]] std::string escaped(const std::string& text);
/// A number with `digits` behind the point, without a sign on zero.
[[nodiscard]] std::string fixed(double value, int digits);

}  // namespace dseam::program
