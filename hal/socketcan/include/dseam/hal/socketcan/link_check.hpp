// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dseam/base/result.hpp"

namespace dseam::hal::socketcan {

/// What the kernel knows about a network interface.
struct LinkInfo {
  bool up = false;
  std::string kind;  ///< "can", "vcan", "vxcan"; empty for what is no virtual or CAN interface.
  std::uint32_t mtu = 0;
  std::uint32_t queue_frames = 0;
  std::uint32_t bits_per_s = 0;       ///< 0: virtual, or not configured.
  std::uint32_t data_bits_per_s = 0;  ///< Of FD frames.
  std::uint32_t restart_ms = 0;       ///< 0: a controller that went bus-off stays so.
  std::uint32_t state = 0;            ///< As linux/can/netlink.h numbers them.
};

/// How the weld link wants it.
struct LinkWishes {
  bool fd = true;
  std::uint32_t bits_per_s = 0;  ///< 0: any.
  std::uint32_t data_bits_per_s = 0;
  std::uint32_t least_queue_frames = 16;
};

/// One remark on an interface, with what to do about it.
struct Finding {
  bool refuse = false;  ///< The link cannot work as it is; otherwise a warning.
  std::string text;
  std::string cure;  ///< A command, where one helps.
};

/// Asks the kernel (rtnetlink).
///
/// Errors:  kNotFound: no such interface. kIo: the kernel did not answer.
[[nodiscard]] Result<LinkInfo> read_link(std::string_view interface);
/// Reads the kernel's answer.
///
/// Errors:  kBadData: not an answer about an interface.
[[nodiscard]] Result<LinkInfo> parse_link(std::span<const std::byte> answer);
/// What is wrong with `info`; nothing for an interface that will do.
[[nodiscard]] std::vector<Finding> judge_link(std::string_view interface, const LinkInfo& info,
                                              const LinkWishes& wishes);
/// Why there is no such interface, or no CAN at all.
[[nodiscard]] Finding explain_open(std::string_view interface, Errc error);

}  // namespace dseam::hal::socketcan
