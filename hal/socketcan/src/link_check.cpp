// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/socketcan/link_check.hpp"

#include <linux/can.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace dseam::hal::socketcan {
namespace {

using Bytes = std::span<const std::byte>;

/// Above them an attribute says how it is nested.
constexpr unsigned kTypeBits = 0x3FFF;

template <typename Plain>
bool read_plain(Bytes bytes, Plain& out) {
  if (bytes.size() < sizeof(Plain)) {
    return false;
  }
  std::memcpy(&out, bytes.data(), sizeof(Plain));
  return true;
}

std::uint32_t number_in(Bytes payload) {
  std::uint32_t number = 0;
  static_cast<void>(read_plain(payload, number));
  return number;
}

/// Calls `each(type, payload)` for the attributes in `bytes`; stops where they make no sense.
template <typename Each>
void for_each_attribute(Bytes bytes, const Each& each) {
  rtattr head{};
  while (read_plain(bytes, head) && head.rta_len >= sizeof(head) && head.rta_len <= bytes.size()) {
    each(head.rta_type & kTypeBits, bytes.subspan(sizeof(head), head.rta_len - sizeof(head)));
    bytes = bytes.subspan(std::min<std::size_t>(RTA_ALIGN(head.rta_len), bytes.size()));
  }
}

void read_can(Bytes attributes, LinkInfo& info) {
  for_each_attribute(attributes, [&info](unsigned type, Bytes payload) {
    can_bittiming timing{};
    if (type == IFLA_CAN_BITTIMING && read_plain(payload, timing)) {
      info.bits_per_s = timing.bitrate;
    } else if (type == IFLA_CAN_DATA_BITTIMING && read_plain(payload, timing)) {
      info.data_bits_per_s = timing.bitrate;
    } else if (type == IFLA_CAN_RESTART_MS) {
      info.restart_ms = number_in(payload);
    } else if (type == IFLA_CAN_STATE) {
      info.state = number_in(payload);
    }
  });
}

void read_kind(Bytes attributes, LinkInfo& info) {
  for_each_attribute(attributes, [&info](unsigned type, Bytes payload) {
    if (type == IFLA_INFO_KIND) {
      const char* text = reinterpret_cast<const char*>(payload.data());  // NOLINT: it is text.
      info.kind = std::string(text, strnlen(text, payload.size()));
    } else if (type == IFLA_INFO_DATA && info.kind == "can") {
      read_can(payload, info);
    }
  });
}

/// A socket that closes itself.
class Netlink {
 public:
  Netlink() : fd_(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE)) {
    const timeval patience{1, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  }
  Netlink(const Netlink&) = delete;
  Netlink& operator=(const Netlink&) = delete;
  ~Netlink() { ::close(fd_); }

  bool ask(unsigned index) const {
    struct {
      nlmsghdr head;
      ifinfomsg body;
    } request{};
    request.head.nlmsg_len = sizeof(request);
    request.head.nlmsg_type = RTM_GETLINK;
    request.head.nlmsg_flags = NLM_F_REQUEST;
    request.body.ifi_index = static_cast<int>(index);
    return ::send(fd_, &request, sizeof(request), 0) == sizeof(request);
  }
  Bytes answer(std::span<std::byte> room) const {
    const auto size = ::recv(fd_, room.data(), room.size(), 0);
    return Bytes(room).first(size > 0 ? static_cast<std::size_t>(size) : 0);
  }

 private:
  int fd_;
};

std::string rate_command(std::string_view interface, const LinkWishes& wishes) {
  const auto rate = [](std::uint32_t wish, const char* usual) {
    return wish == 0 ? std::string(usual) : std::to_string(wish);
  };
  std::string command = "ip link set " + std::string(interface) + " down type can bitrate " +
                        rate(wishes.bits_per_s, "1000000");
  if (wishes.fd) {
    command += " dbitrate " + rate(wishes.data_bits_per_s, "5000000") + " fd on";
  }
  return command + " restart-ms 0 && ip link set " + std::string(interface) + " up";
}

}  // namespace

Result<LinkInfo> parse_link(Bytes answer) {
  nlmsghdr head{};
  ifinfomsg body{};
  if (!read_plain(answer, head) || head.nlmsg_type != RTM_NEWLINK ||
      head.nlmsg_len > answer.size() || head.nlmsg_len < NLMSG_LENGTH(sizeof(body)) ||
      !read_plain(answer.subspan(NLMSG_HDRLEN), body)) {
    return Errc::kBadData;
  }
  LinkInfo info;
  info.up = (body.ifi_flags & IFF_UP) != 0;
  const std::size_t at = NLMSG_SPACE(sizeof(body));
  const Bytes attributes = at < head.nlmsg_len ? answer.subspan(at, head.nlmsg_len - at) : Bytes();
  for_each_attribute(attributes, [&info](unsigned type, Bytes payload) {
    if (type == IFLA_MTU) {
      info.mtu = number_in(payload);
    } else if (type == IFLA_TXQLEN) {
      info.queue_frames = number_in(payload);
    } else if (type == IFLA_LINKINFO) {
      read_kind(payload, info);
    }
  });
  return info;
}

Result<LinkInfo> read_link(std::string_view interface) {
  const unsigned index = ::if_nametoindex(std::string(interface).c_str());
  if (index == 0) {
    return Errc::kNotFound;
  }
  const Netlink netlink;
  alignas(nlmsghdr) std::array<std::byte, 32768> room{};
  if (!netlink.ask(index)) {
    return Errc::kIo;
  }
  const Bytes answer = netlink.answer(room);
  return answer.empty() ? Result<LinkInfo>(Errc::kIo) : parse_link(answer);
}

std::vector<Finding> judge_link(std::string_view interface, const LinkInfo& info,
                                const LinkWishes& wishes) {
  std::vector<Finding> findings;
  const std::string name(interface);
  const bool virtual_bus = info.kind == "vcan" || info.kind == "vxcan";
  if (info.kind != "can" && !virtual_bus) {
    return {{true, name + " is not a CAN interface", "ip -details link show type can"}};
  }
  if (!info.up) {
    findings.push_back({true, name + " is down",
                        virtual_bus ? "ip link set " + name + " up" : rate_command(name, wishes)});
  }
  if (wishes.fd && info.mtu < CANFD_MTU) {
    findings.push_back({true, name + " carries classic frames only",
                        virtual_bus ? "ip link set " + name + " mtu 72"
                                    : rate_command(name, wishes) + ", or set link.classic"});
  }
  const bool other_rate = wishes.bits_per_s != 0 && info.bits_per_s != wishes.bits_per_s;
  const bool other_data_rate =
      wishes.fd && wishes.data_bits_per_s != 0 && info.data_bits_per_s != wishes.data_bits_per_s;
  if (!virtual_bus && (other_rate || other_data_rate)) {
    findings.push_back({true,
                        name + " runs at " + std::to_string(info.bits_per_s) + "/" +
                            std::to_string(info.data_bits_per_s) + " bit/s",
                        rate_command(name, wishes)});
  }
  if (!virtual_bus && info.restart_ms != 0) {
    findings.push_back({false,
                        name + " restarts by itself after bus-off and then sends what is queued",
                        rate_command(name, wishes)});
  }
  if (!virtual_bus && info.queue_frames < wishes.least_queue_frames) {
    findings.push_back(
        {false, name + " queues " + std::to_string(info.queue_frames) + " frames only",
         "ip link set " + name + " txqueuelen " + std::to_string(wishes.least_queue_frames)});
  }
  return findings;
}

Finding explain_open(std::string_view interface, Errc error) {
  const std::string name(interface);
  switch (error) {
    case Errc::kNotFound:
      return {true, "there is no interface " + name,
              "for a trial: ip link add dev " + name + " type vcan && ip link set " + name +
                  " mtu 72 up"};
    case Errc::kUnsupported:
      return {true, "the kernel has no CAN, or " + name + " carries classic frames only",
              "modprobe can_raw; ip link set " + name + " mtu 72"};
    case Errc::kUnavailable:
      return {true, "not permitted to open " + name, "run as root or with CAP_NET_RAW"};
    default:
      return {true, std::string("opening ") + name + " failed: " + dseam::name(error),
              "ip -details link show " + name};
  }
}

}  // namespace dseam::hal::socketcan
