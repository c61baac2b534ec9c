// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/socketcan/error_frame.hpp"

#include <linux/can/error.h>

namespace dseam::hal::socketcan {
namespace {

std::optional<BusState> state_of_controller(unsigned status) noexcept {
  if ((status & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
    return BusState::kErrorPassive;
  }
  if ((status & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
    return BusState::kErrorWarning;
  }
  if ((status & CAN_ERR_CRTL_ACTIVE) != 0) {
    return BusState::kErrorActive;
  }
  return std::nullopt;
}

}  // namespace

std::optional<BusState> count_error(const can_frame& frame, ErrorCounts& counts) noexcept {
  const auto reports = [&frame](unsigned bit) { return (frame.can_id & bit) != 0 ? 1U : 0U; };
  counts.tx_timeout += reports(CAN_ERR_TX_TIMEOUT);
  counts.lost_arbitration += reports(CAN_ERR_LOSTARB);
  counts.controller += reports(CAN_ERR_CRTL);
  counts.protocol += reports(CAN_ERR_PROT);
  counts.transceiver += reports(CAN_ERR_TRX);
  counts.no_ack += reports(CAN_ERR_ACK);
  counts.bus_off += reports(CAN_ERR_BUSOFF);
  counts.bus_error += reports(CAN_ERR_BUSERROR);
  counts.restarted += reports(CAN_ERR_RESTARTED);
  if (reports(CAN_ERR_BUSOFF) != 0) {
    return BusState::kBusOff;
  }
  if (reports(CAN_ERR_RESTARTED) != 0) {
    return BusState::kErrorActive;
  }
  if (reports(CAN_ERR_CRTL) != 0) {
    constexpr unsigned kOverflow = CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW;
    counts.controller_overflow += (frame.data[1] & kOverflow) != 0 ? 1U : 0U;
    return state_of_controller(frame.data[1]);
  }
  return std::nullopt;
}

}  // namespace dseam::hal::socketcan
