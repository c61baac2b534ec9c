// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/socketcan/link_check.hpp"

#include <algorithm>
#include <iostream>

#include "command/commands.hpp"

namespace dseam::program {
namespace {

using hal::socketcan::Finding;

void print(const Finding& finding) {
  std::cout << (finding.refuse ? "refused: " : "warning: ") << finding.text << '\n';
  if (!finding.cure.empty()) {
    std::cout << "  try: " << finding.cure << '\n';
  }
}

void print(const std::string& interface, const hal::socketcan::LinkInfo& info) {
  std::cout << interface << ": " << (info.kind.empty() ? "no CAN interface" : info.kind) << ", "
            << (info.up ? "up" : "down") << ", frames of " << info.mtu << " bytes, queue "
            << info.queue_frames;
  if (info.bits_per_s > 0) {
    std::cout << ", " << info.bits_per_s << " bit/s, FD data " << info.data_bits_per_s << " bit/s";
  }
  std::cout << '\n';
}

}  // namespace

ExitCode run_link_check(const LinkCheckOptions& options, const Invocation& invocation) {
  const std::string& interface = options.interface;
  Settings settings;
  invocation.configure(settings);
  const auto info = hal::socketcan::read_link(interface);
  if (!info.ok()) {
    const Finding finding = hal::socketcan::explain_open(interface, info.error());
    throw Failure(ExitCode::kDevice,
                  finding.text + (finding.cure.empty() ? "" : "\ntry: " + finding.cure));
  }
  print(interface, info.value());
  const auto findings = hal::socketcan::judge_link(
      interface, info.value(), {.fd = !settings.session.link.addressing.classic});
  for (const Finding& finding : findings) {
    print(finding);
  }
  const bool refused =
      std::any_of(findings.begin(), findings.end(), [](const Finding& f) { return f.refuse; });
  std::cout << (refused ? "the weld link cannot run on it\n" : "the weld link can run on it\n");
  return refused ? ExitCode::kDevice : ExitCode::kDone;
}

}  // namespace dseam::program
