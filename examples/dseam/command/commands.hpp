// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "command/invocation.hpp"

namespace dseam::program {

// Each adds its sub-command, which stores in `invocation.run` what it does.
void add_calibrate(CLI::App& app, Invocation& invocation);
void add_cameras(CLI::App& app, Invocation& invocation);
void add_config(CLI::App& app, Invocation& invocation);
void add_extract(CLI::App& app, Invocation& invocation);
void add_fit(CLI::App& app, Invocation& invocation);
void add_link_check(CLI::App& app, Invocation& invocation);
void add_record(CLI::App& app, Invocation& invocation);
void add_robot(CLI::App& app, Invocation& invocation);
void add_rt_report(CLI::App& app, Invocation& invocation);
void add_splice(CLI::App& app, Invocation& invocation);
void add_weld(CLI::App& app, Invocation& invocation);

}  // namespace dseam::program
