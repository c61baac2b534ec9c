// SPDX-License-Identifier: Apache-2.0
#include "scan/sim_scan.hpp"

#include "failure.hpp"

namespace dseam::program {
namespace {

hal::sim::Cell cell_of(const hal::sim::CellConfig& config) {
  auto cell = hal::sim::Cell::make(config);
  if (!cell.ok()) {
    throw Failure(ExitCode::kUsage,
                  std::string("the simulated cell: ") + hal::sim::fault_in(config));
  }
  return std::move(cell.value());
}

std::unique_ptr<hal::sim::SimScanner> scanner_of(const hal::sim::Cell& cell, hal::Clock& clock) {
  auto scanner = hal::sim::SimScanner::make(cell, {}, clock);
  if (!scanner.ok()) {
    throw Failure(ExitCode::kUsage, "the simulated scanner: too many views");
  }
  return std::move(scanner.value());
}

}  // namespace

SimScan::SimScan(const hal::sim::CellConfig& config)
    : cell_(cell_of(config)), scanner_(scanner_of(cell_, clock_)) {}

}  // namespace dseam::program
