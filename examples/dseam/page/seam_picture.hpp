// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "report/job_report.hpp"

namespace dseam::program {

struct SeamPicture {
  std::string caption;
  std::string svg;  ///< The shaded cloud as an image, the seam and the path drawn over it.
};

/// Scan and seam from three directions: along the nozzle's axis, and from two sides above.
[[nodiscard]] std::array<SeamPicture, 3> seam_pictures(const JobReport& job);

}  // namespace dseam::program
