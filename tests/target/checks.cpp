// SPDX-License-Identifier: Apache-2.0
// Runs on the bare microcontroller: a rigid transform and an arena, the same checks as on the host.
#include <array>
#include <cmath>
#include <cstddef>

#include "dseam/base/arena.hpp"
#include "dseam/geometry/rigid_transform.hpp"
#include "start.hpp"

namespace {

alignas(32) std::array<std::byte, 4096> lent_memory;

bool the_arena_lends_and_refuses() {
  dseam::Arena arena(lent_memory);
  const bool lent = arena.take<float>(512).size() == 512;
  const bool refused = arena.take<float>(1024).empty() && arena.exhausted();
  return lent && refused;
}

bool a_transform_and_its_inverse_cancel() {
  const dseam::geometry::RigidTransform T_a_b{dseam::geometry::rotation_exp({0.1, -0.7, 0.4}),
                                              {120.0, -35.0, 800.0}};
  const Eigen::Vector3d p_b(10.0, 20.0, 30.0);
  return ((T_a_b.inverse() * (T_a_b * p_b)) - p_b).norm() < 1e-9;
}

}  // namespace

int dseam::target::run_checks() noexcept {
  const bool passed = the_arena_lends_and_refuses() && a_transform_and_its_inverse_cancel();
  print(passed ? "target: PASS\n" : "target: FAIL\n");
  return passed ? 0 : 1;
}
