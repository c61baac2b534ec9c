// SPDX-License-Identifier: Apache-2.0
#include "rt/session/cell/virtual_vision.hpp"

#include <algorithm>

namespace dseam::test {
namespace {

constexpr std::int64_t kPeriodNs = 33'000'000;
constexpr std::size_t kFrames = 4;

depth::DepthModel small_model() {
  return {.intrinsics = {.width = 8, .height = 6, .fx = 10, .fy = 10}};
}

}  // namespace

VirtualVision::VirtualVision(std::uint64_t seed, hal::Clock& clock)
    : clock_(clock),
      random_(seed, 3),
      scene_(hal::fake::FakeCamera::pool_bytes(small_model(), 1), std::byte{1}),
      pool_(hal::fake::FakeCamera::pool_bytes(small_model(), kFrames)),
      camera_({.model = small_model(),
               .period_ns = kPeriodNs,
               .depth = scene_,
               .gray = {},
               .pool = pool_},
              clock),
      monitor_({.period_ns = kPeriodNs}) {
  play(hal::fake::DeviceFault::kNone);
  heart_.beat(clock.now_ns());
  (void)camera_.start(hal::FrameMode::kLatest);
}

void VirtualVision::play(hal::fake::DeviceFault fault) {
  script_ = {fault, UINT32_MAX};
  camera_.play({&script_, 1});
}

void VirtualVision::step() {
  const std::int64_t now_ns = clock_.now_ns();
  if (hangs || (looks_ && now_ns < done_ns_)) {
    return;
  }
  if (looks_) {
    looks_ = false;
    news_.write(sees_);
    heart_.beat(now_ns);
  }
  const auto lease = camera_.next(std::chrono::nanoseconds{0});
  const auto verdict = lease.ok() ? monitor_.on_frame(lease.value().frame(), now_ns)
                                  : monitor_.on_absence(lease.error(), now_ns);
  if (verdict == hal::CameraVerdict::kGood) {
    looks_ = true;
    done_ns_ = now_ns + 1'000'000 * (2 + random_.below(20));
    sees_ =
        shows_the_seam(lease.value().frame()) ? seam::Confidence::kHigh : seam::Confidence::kNone;
  }
}

bool VirtualVision::shows_the_seam(const hal::DepthFrame& frame) const {
  return !doubts && std::equal(frame.depth.begin(), frame.depth.end(), scene_.begin());
}

void VirtualVision::tell(rt::WeldSession::Inputs& in) {
  (void)news_.read(in.confidence);
  in.vision_silent_ns = heart_.silent_ns(clock_.now_ns());
}

}  // namespace dseam::test
