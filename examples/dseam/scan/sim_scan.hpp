// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/sim/sim_scanner.hpp"
#include "scan/scan.hpp"

namespace dseam::program {

/// The simulated cell's scanner, in virtual time: it does not wait between its views.
class SimScan final : public ScanSource {
 public:
  /// Errors:  throws Failure(kUsage) that says which value no cell can be built from.
  explicit SimScan(const hal::sim::CellConfig& config);

  hal::DepthCamera& camera() override { return *scanner_; }
  hal::RobotState* robot_state() override { return &scanner_->robot_state(); }
  [[nodiscard]] std::size_t num_views() const override { return scanner_->num_views(); }
  [[nodiscard]] std::string description() const override { return "simulated cell"; }
  [[nodiscard]] const hal::sim::Cell& cell() const { return cell_; }

 private:
  hal::fake::ManualClock clock_;
  hal::sim::Cell cell_;
  std::unique_ptr<hal::sim::SimScanner> scanner_;
};

}  // namespace dseam::program
