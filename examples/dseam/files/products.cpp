// SPDX-License-Identifier: Apache-2.0
#include "files/products.hpp"

#include <iostream>
#include <nlohmann/json.hpp>

#include "files/cloud_writer.hpp"
#include "files/csv_writers.hpp"
#include "page/page.hpp"
#include "report/report_json.hpp"
#include "report/text.hpp"

namespace dseam::program {

void write_products(const JobReport& job, OutputFolder& folder) {
  if (!job.seam_base.points.empty()) {
    folder.write("seam.csv", [&](std::ostream& out) { write_seam_csv(job.seam_base, out); });
  }
  if (!job.path.empty()) {
    folder.write("path.csv", [&](std::ostream& out) { write_path_csv(job.path, out); });
  }
  if (!job.views.empty()) {
    folder.write("poses.json",
                 [&](std::ostream& out) { out << poses_json(job.views).dump(1) << '\n'; });
  }
  if (job.cloud_base.points.size() > 0) {
    folder.write("merged.ply", [&](std::ostream& out) { write_ply(job.cloud_base, out); });
  }
  folder.write("report.json", [&](std::ostream& out) { out << report_json(job).dump(1) << '\n'; });
  folder.write("report.html", [&](std::ostream& out) { out << page(job); });
  folder.commit();
}

void print_summary(const JobReport& job, const OutputFolder& folder) {
  std::cout << (job.weld ? "accepted: " : "refused: ") << job.reason << '\n';
  if (!job.fault.empty()) {
    std::cout << "not welded to the end: " << job.fault << '\n';
  }
  if (!job.seam_base.points.empty()) {
    std::cout << "seam: " << fixed(job.seam_base.length_mm, 1) << " mm, "
              << job.seam_base.points.size() << " points\n";
  }
  for (const auto& [what, value] : job.robot) {
    std::cout << what << ": " << value << '\n';
  }
  std::cout << "report: " << folder.path("report.html").string() << '\n';
}

}  // namespace dseam::program
