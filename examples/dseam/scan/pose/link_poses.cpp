// SPDX-License-Identifier: Apache-2.0
#include "scan/pose/link_poses.hpp"

#include <chrono>
#include <random>

#include "failure.hpp"
#include "robot/can_robot_side.hpp"

namespace dseam::program {
namespace {

constexpr std::int64_t kPeriodNs = 1'000'000;
constexpr std::int64_t kAnswerLimitNs = 3'000'000'000;
constexpr std::int64_t kReportLimitNs = 300'000'000;

link::Sender sender_of(const link::Sender::Config& config) {
  auto sender = link::Sender::make(config);
  if (!sender.ok()) {
    throw Failure(ExitCode::kUsage, "the configured weld link: a limit is out of range");
  }
  return sender.value();
}

/// Waits for `done`, at most `limit_ns`.
template <typename Done>
bool wait_for(hal::Clock& clock, std::int64_t limit_ns, const Done& done) {
  const std::int64_t end_ns = clock.now_ns() + limit_ns;
  while (!done() && clock.now_ns() < end_ns) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return done();
}

}  // namespace

LinkPoses::LinkPoses(hal::CanBus& bus, const link::Sender::Config& config, std::uint32_t session,
                     std::int64_t now_ns)
    : port_(bus), sender_(sender_of(config)) {
  (void)sender_.connect(session, now_ns);
}

void LinkPoses::step(std::int64_t now_ns) {
  port_.turn(sender_, now_ns);
  const link::PoseReport& report = sender_.pose();
  if (report.robot_time_us == robot_time_us_ || sender_.report().statuses == 0) {
    return;  // Nothing new, or not yet known what the robot's clock says.
  }
  robot_time_us_ = report.robot_time_us;
  const std::int64_t stamp_ns =
      static_cast<std::int64_t>(report.robot_time_us) * 1000 + sender_.clock_offset_ns();
  const bool taken = poses_
                         .push({stamp_ns,
                                hal::PoseOf::kFlange,
                                {report.pose.q_base_torch.toRotationMatrix(), report.pose.p_base}})
                         .ok();
  reports_ += taken ? 1U : 0U;
}

ListeningToRobot::ListeningToRobot(const std::string& interface, const link::Sender::Config& config)
    : bus_(open_can(interface, config.addressing.classic)),
      poses_(*bus_, config, std::random_device()() | 1U, static_cast<hal::Clock&>(clock_).now_ns()),
      thread_([this] { listen(); }) {
  if (!wait_for(clock_, kAnswerLimitNs, [this] { return poses_.reporting(); })) {
    ended_ = true;
    thread_.join();
    throw Failure(ExitCode::kDevice, "can:" + interface + ": no robot reports its pose");
  }
}

ListeningToRobot::~ListeningToRobot() {
  ended_ = true;
  thread_.join();
}

void ListeningToRobot::listen() {
  hal::Clock& clock = clock_;
  for (std::int64_t due_ns = clock.now_ns(); !ended_;) {
    poses_.step(clock.now_ns());
    due_ns = std::max(due_ns + kPeriodNs, clock.now_ns());
    clock.sleep_until(due_ns);
  }
}

void ListeningToRobot::await(std::int64_t stamp_ns) {
  (void)wait_for(clock_, kReportLimitNs, [&] { return poses_.state().pose_at(stamp_ns).ok(); });
}

}  // namespace dseam::program
