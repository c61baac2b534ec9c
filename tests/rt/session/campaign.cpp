// SPDX-License-Identifier: Apache-2.0
#include "campaign.hpp"

#include "rt/session/cell/faults.hpp"

namespace dseam::test {
namespace {

using E = rt::SessionEvent;
using S = rt::SessionState;
constexpr std::int64_t kMs = 1'000'000;

/// From wherever the cell is: stop what moves, reset what is latched.
bool to_idle(VirtualCell& cell) {
  const auto quiet = [&] {
    return cell.session.state() < S::kArmed || cell.session.state() == S::kSafe;
  };
  (void)cell.session.order(E::kStop);
  if (!cell.run_until(quiet, 5000 * kMs)) {
    return false;
  }
  cell.inputs.operator_enable = false;
  cell.run(30 * kMs);
  (void)cell.session.order(E::kReset);
  (void)cell.session.order(E::kDiscard);
  return cell.session.state() == S::kIdle;
}

void strike(VirtualCell& cell, Pcg32& random, SeedResult& result) {
  const auto& kinds = fault_kinds();
  const FaultKind& first = kinds[random.below(static_cast<std::uint32_t>(kinds.size()))];
  const FaultKind& second = kinds[random.below(static_cast<std::uint32_t>(kinds.size()))];
  const bool both = random.below(4) == 0;
  first.begin(cell);
  ++result.faults;
  cell.run(random.below(20) * kMs);
  if (both) {
    second.begin(cell);
    ++result.faults;
  }
  // Orders in between, as an impatient operator gives them.
  (void)cell.session.order(static_cast<E>(random.below(rt::kNumSessionEvents)));
  cell.run(std::min(first.lasts_ns, random.below(400) * kMs));
  first.end(cell);
  if (both) {
    second.end(cell);
  }
  result.latched += cell.session.fault() != rt::Fault::kNone ? 1U : 0U;
}

}  // namespace

SeedResult run_seed(std::uint64_t seed, std::uint32_t faults) {
  SeedResult result;
  Pcg32 random(seed, 2);
  rt::WeldSession::Config config;
  config.vision_limit_ns = 200 * kMs;
  VirtualCell cell(seed, config);
  const std::int64_t begin_ns = cell.now_ns();
  const auto stuck = [&](const char* where) {
    if (result.breach.empty()) {
      result.breach = std::string("stuck ") + where + " in " + name(cell.session.state()) +
                      ", fault " + name(cell.session.fault()) + ", link " +
                      name(cell.sender().fault()) + ", robot " + name(cell.robot().fault());
    }
  };
  while (result.faults < faults && result.breach.empty()) {
    const auto wanted = static_cast<S>(random.below(6));
    const bool there = cell.bring_to(wanted);
    if (!there && wanted != S::kIdle && cell.session.fault() == rt::Fault::kNone) {
      stuck("on the way");
    }
    cell.run(random.below(wanted == S::kRunning ? 1500 : 50) * kMs);
    strike(cell, random, result);
    if (!to_idle(cell)) {
      stuck("after a fault");
    }
    result.breach = result.breach.empty() ? cell.breach() : result.breach;
  }
  const bool welds = cell.bring_to(S::kRunning) &&
                     cell.run_until([&] { return cell.session.state() == S::kIdle; }, 6000 * kMs);
  if (!welds || cell.executed() != cell.path_points()) {
    stuck("in the last weld");
  }
  result.breach = result.breach.empty() ? cell.breach() : result.breach;
  result.digest = cell.digest();
  result.simulated_s = 1e-9 * static_cast<double>(cell.now_ns() - begin_ns);
  return result;
}

}  // namespace dseam::test
