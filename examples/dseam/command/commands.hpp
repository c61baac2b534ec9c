// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "command/invocation.hpp"

namespace dseam::program {

// What each command is told beside what all are told (Invocation). command_line.cpp reads them.

struct CalibrateOptions {
  std::filesystem::path pairs;
  std::filesystem::path out;
};

struct ConfigOptions {
  bool print = false;
};

struct ExtractOptions {
  std::vector<std::filesystem::path> clouds;
  std::filesystem::path out;
};

struct FitOptions {
  std::filesystem::path points;
  std::filesystem::path out;
};

struct LinkCheckOptions {
  std::string interface;
};

struct RecordOptions {
  std::string camera;
  std::filesystem::path out;
};

struct RobotOptions {
  std::string interface;
};

struct RtReportOptions {
  double seconds = 0.0;
};

struct SpliceOptions {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path hand_eye;
  std::filesystem::path out;
};

struct WeldOptions {
  std::string camera;
  std::string robot = "none";
  bool waive_operator = false;
  std::filesystem::path hand_eye;
  std::filesystem::path out;
  std::filesystem::path truth;
};

struct CamerasOptions {};

ExitCode run_calibrate(const CalibrateOptions& options, const Invocation& invocation);
ExitCode run_cameras(const CamerasOptions& options, const Invocation& invocation);
ExitCode run_config(const ConfigOptions& options, const Invocation& invocation);
ExitCode run_extract(const ExtractOptions& options, const Invocation& invocation);
ExitCode run_fit(const FitOptions& options, const Invocation& invocation);
ExitCode run_link_check(const LinkCheckOptions& options, const Invocation& invocation);
ExitCode run_record(const RecordOptions& options, const Invocation& invocation);
ExitCode run_robot(const RobotOptions& options, const Invocation& invocation);
ExitCode run_rt_report(const RtReportOptions& options, const Invocation& invocation);
ExitCode run_splice(const SpliceOptions& options, const Invocation& invocation);
ExitCode run_weld(const WeldOptions& options, const Invocation& invocation);

}  // namespace dseam::program
