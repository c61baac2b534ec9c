// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <numbers>
#include <vector>

#include "command/commands.hpp"
#include "dseam/seam/curve/closed_curve_fit.hpp"
#include "files/products.hpp"
#include "input/cloud_reader.hpp"
#include "job/lent_memory.hpp"
#include "job/stopwatch.hpp"
#include "report/curve_report.hpp"
#include "report/text.hpp"
#include "report/verdict.hpp"

namespace dseam::program {
namespace {

using seam::ClosedCurveFit;

std::vector<Eigen::Vector3d> vectors_of(const LoadedCloud& cloud) {
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    points.emplace_back(cloud.x[i], cloud.y[i], cloud.z[i]);
  }
  return points;
}

void print(const ClosedCurveFit::Report& fit) {
  std::cout << "orthogonal rms " << fixed(fit.orthogonal.rms_mm, 3) << " mm; lateral "
            << fixed(fit.lateral.rms_mm, 3) << ", normal " << fixed(fit.normal.rms_mm, 3) << " mm\n"
            << "R-squared " << fixed(fit.r_squared.x(), 5) << ' ' << fixed(fit.r_squared.y(), 5)
            << ' ' << fixed(fit.r_squared.z(), 5) << " with " << ClosedCurveFit::kCoefficients
            << " coefficients an axis\n"
            << "largest hole " << fixed(fit.largest_hole_rad * 180.0 / std::numbers::pi, 1)
            << " degrees, " << fixed(fit.largest_hole_mm, 1) << " mm\n";
}

}  // namespace

ExitCode run_fit(const FitOptions& options, const Invocation& invocation) {
  Settings settings;
  invocation.configure(settings);
  OutputFolder folder(options.out);
  Stopwatch watch;
  const auto points = vectors_of(read_csv_points(options.points, invocation.mm_per_unit()));
  LentMemory memory(ClosedCurveFit::bytes(points.size()) +
                    Arena::bytes<seam::SeamPoint>(settings.max_seam_points));
  ClosedCurveFit stage(points.size(), memory.arena());
  Buffer<seam::SeamPoint> curve(memory.arena().take<seam::SeamPoint>(settings.max_seam_points));

  const ClosedCurveFit::Report fit = stage.run(points, settings.seam.point_spacing_mm, curve);

  JobReport job;
  job.command = "fit";
  job.input = options.points.string();
  job.stages.push_back(curve_row(fit, watch.lap_ms()));
  job.seam_report = seam_report_of(fit);
  job.seam_base = view_of(curve.view(), job.seam_report);
  job.weld = job.seam_report.weld();
  job.reason = job.weld ? "a closed curve, " + fixed(fit.orthogonal.rms_mm, 3) + " mm rms"
                        : reason_of(job.seam_report, settings.seam);
  write_products(job, folder);
  if (job.weld) {
    print(fit);
  }
  print_summary(job, folder);
  return exit_code_of(job.seam_report);
}

}  // namespace dseam::program
