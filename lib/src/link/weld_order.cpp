// SPDX-License-Identifier: Apache-2.0
#include "dseam/link/weld_order.hpp"

namespace dseam::link {

WeldProgress give_next_order(Sender& sender, const WeldOrder& weld, std::int64_t now_ns) noexcept {
  Result<> given;
  switch (sender.state()) {
    case HostState::kOffline:
      given = sender.connect(weld.session, now_ns);
      break;
    case HostState::kIdle:
      given = sender.expect(weld.points);
      given = given.ok() ? sender.arm(now_ns) : given;
      break;
    case HostState::kArmed:
      given = sender.load(weld.points, weld.trajectory, now_ns);
      break;
    case HostState::kReady:
      sender.permit_weld(weld.weld_permit);
      given = sender.start(now_ns);
      break;
    case HostState::kDone:
      return WeldProgress::kDone;
    case HostState::kSafe:
      return WeldProgress::kFailed;
    default:
      break;
  }
  if (!given.ok()) {
    sender.abort(Fault::kIncompatible, now_ns);
    return WeldProgress::kFailed;
  }
  return WeldProgress::kUnderWay;
}

}  // namespace dseam::link
