// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/v4l2/v4l2_camera.hpp"

#include <utility>

#include "session.hpp"

namespace dseam::hal::v4l2 {

Result<std::unique_ptr<V4l2Camera>> V4l2Camera::open(const V4l2Config& config, V4l2Sys& sys,
                                                     std::string& problem) {
  auto session = std::make_unique<Session>(config, sys);
  if (const auto opened = session->open(problem); !opened.ok()) {
    return opened.error();
  }
  return std::unique_ptr<V4l2Camera>(new V4l2Camera(std::move(session)));
}

V4l2Camera::V4l2Camera(std::unique_ptr<Session> session) noexcept : session_(std::move(session)) {}

V4l2Camera::~V4l2Camera() = default;

V4l2State V4l2Camera::state() const noexcept { return session_->state(); }
V4l2Grant V4l2Camera::grant() const { return session_->grant(); }

const depth::DepthModel& V4l2Camera::do_model() const noexcept { return session_->model(); }

Result<> V4l2Camera::do_start(FrameMode mode) noexcept { return session_->start(mode); }

Result<FrameLease> V4l2Camera::do_next(std::chrono::nanoseconds timeout) noexcept {
  std::uint32_t slot = 0;
  const auto frame = session_->next(timeout, slot);
  return frame.ok() ? Result<FrameLease>(FrameLease(*this, frame.value(), slot)) : frame.error();
}

void V4l2Camera::do_stop() noexcept { session_->stop(); }

CameraHealth V4l2Camera::do_health() const noexcept { return session_->health(); }

void V4l2Camera::do_give_back(std::uint32_t slot) noexcept { session_->give_back(slot); }

}  // namespace dseam::hal::v4l2
