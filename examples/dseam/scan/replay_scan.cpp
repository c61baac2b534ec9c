// SPDX-License-Identifier: Apache-2.0
#include "scan/replay_scan.hpp"

#include <utility>

#include "failure.hpp"

namespace dseam::program {
namespace {

template <typename T>
T value_or_fail(hal::replay::Loaded<T> loaded) {
  if (!loaded.ok()) {
    throw Failure(ExitCode::kInput, loaded.fault());
  }
  return std::move(loaded.value());
}

}  // namespace

ReplayScan::ReplayScan(const std::filesystem::path& set)
    : set_(set),
      camera_(value_or_fail(hal::replay::ReplayCamera::make(
          value_or_fail(hal::replay::read_scan_set(set)), {.step = true}, clock_))) {}

}  // namespace dseam::program
