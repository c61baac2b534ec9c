// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/hal/camera/camera_monitor.hpp"
#include "dseam/hal/fake/fake_camera.hpp"
#include "dseam/rt/latest_value.hpp"
#include "dseam/rt/timing/deadline.hpp"
#include "dseam/rt/weld_session.hpp"

namespace dseam::test {

/// A camera that watches the weld, and what looks at its images: the vision thread, a step at a
/// time. What it sees reaches the cycle as it would from a thread.
class VirtualVision {
 public:
  VirtualVision(std::uint64_t seed, hal::Clock& clock);

  /// Takes a frame, or is done with the one in hand.
  void step();
  /// What the camera does from now on.
  void play(hal::fake::DeviceFault fault);
  /// What the cycle hears of it.
  void tell(rt::WeldSession::Inputs& in);
  [[nodiscard]] std::uint64_t counted(hal::CameraVerdict verdict) const {
    return monitor_.counted(verdict);
  }

  bool hangs = false;   ///< The thread does nothing any more.
  bool doubts = false;  ///< It looks, and sees no seam.

 private:
  [[nodiscard]] bool shows_the_seam(const hal::DepthFrame& frame) const;

  hal::Clock& clock_;
  Pcg32 random_;
  std::vector<std::byte> scene_;
  std::vector<std::byte> pool_;
  hal::fake::FakeCamera camera_;
  hal::fake::FaultStep script_;
  hal::CameraMonitor monitor_;
  bool looks_ = false;  ///< At a frame, until then:
  std::int64_t done_ns_ = 0;
  seam::Confidence sees_ = seam::Confidence::kNone;
  rt::LatestValue<seam::Confidence> news_;
  rt::Heartbeat heart_;
};

}  // namespace dseam::test
