// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "dseam/pipeline/paper_pipeline.hpp"
#include "dseam/pipeline/seam_chain.hpp"
#include "dseam/seam/seam_report.hpp"
#include "failure.hpp"

namespace dseam::program {

/// Why the seam may be welded, or why not, as one sentence with the figures it rests on.
[[nodiscard]] std::string reason_of(const seam::SeamReport& report,
                                    const pipeline::SeamChain::Config& rule);
[[nodiscard]] std::string paper_reason_of(const pipeline::PaperPipeline::Report& report,
                                          const pipeline::PaperPipeline::Config& rule);
/// 0 for a seam, 3 where other input is needed, 4 where the part was seen too badly.
[[nodiscard]] ExitCode exit_code_of(const seam::SeamReport& report);

}  // namespace dseam::program
