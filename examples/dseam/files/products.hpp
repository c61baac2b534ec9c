// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "files/output_folder.hpp"
#include "report/job_report.hpp"

namespace dseam::program {

/// Writes what the job has: seam.csv, path.csv, poses.json, merged.ply, and always report.json and
/// report.html; then commits them and removes the products of an earlier run, so that no old seam
/// lies beside a new refusal.
void write_products(const JobReport& job, OutputFolder& folder);

/// The few lines with which a command ends on the terminal.
void print_summary(const JobReport& job, const OutputFolder& folder);

}  // namespace dseam::program
