// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/aravis/aravis_camera.hpp"

#include <utility>

#include "session/session.hpp"

namespace dseam::hal::aravis {

Result<std::unique_ptr<AravisCamera>> AravisCamera::open(const AravisConfig& config,
                                                         std::string& problem) {
  return open(config, aravis_library(), problem);
}

Result<std::unique_ptr<AravisCamera>> AravisCamera::open(const AravisConfig& config, AravisSys& sys,
                                                         std::string& problem) {
  auto line = std::make_unique<ControlLine>();
  auto device = connect(config, sys, *line, problem);
  if (!device.ok()) {
    return device.error();
  }
  auto session = std::make_unique<Session>(config, sys, std::move(device.value()), std::move(line));
  if (const auto ready = session->prepare(problem); !ready.ok()) {
    return ready.error();
  }
  return std::unique_ptr<AravisCamera>(new AravisCamera(std::move(session)));
}

AravisCamera::AravisCamera(std::unique_ptr<Session> session) noexcept
    : session_(std::move(session)) {}

AravisCamera::~AravisCamera() = default;

AravisState AravisCamera::state() const noexcept { return session_->state(); }
AravisGrant AravisCamera::grant() const { return session_->grant(); }

const depth::DepthModel& AravisCamera::do_model() const noexcept { return session_->model(); }

Result<> AravisCamera::do_start(FrameMode mode) noexcept { return session_->start(mode); }

Result<FrameLease> AravisCamera::do_next(std::chrono::nanoseconds timeout) noexcept {
  std::uint32_t slot = 0;
  const auto frame = session_->next(timeout, slot);
  return frame.ok() ? Result<FrameLease>(FrameLease(*this, frame.value(), slot)) : frame.error();
}

void AravisCamera::do_stop() noexcept { session_->stop(); }

CameraHealth AravisCamera::do_health() const noexcept { return session_->health(); }

void AravisCamera::do_give_back(std::uint32_t slot) noexcept { session_->give_back(slot); }

}  // namespace dseam::hal::aravis
