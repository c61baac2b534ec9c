// SPDX-License-Identifier: Apache-2.0
// Both ends of the weld link and the candump reader under arbitrary frames.
// Input: records of {end and flags, identifier low byte, size, data...}.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>

#include "dseam/base/arena.hpp"
#include "dseam/hal/candump/candump_format.hpp"
#include "dseam/link/codec.hpp"
#include "dseam/link/receiver.hpp"
#include "dseam/link/sender.hpp"

namespace {

using dseam::link::Frame;
using Input = std::span<const std::uint8_t>;

/// With bit 2 of the flags the frame is protected as it should be: the fuzzer cannot guess a CRC.
Frame next_frame(Input& input, std::array<std::uint8_t, 16>& counters) {
  Frame frame;
  const unsigned flags = input[0];
  frame.id = 0x11E + input[1] % 14U;
  frame.fd = (flags & 2U) != 0;
  frame.size_bytes =
      static_cast<std::uint8_t>(std::min<std::size_t>(input[2] % 65U, input.size() - 3));
  for (std::size_t i = 0; i < frame.size_bytes; ++i) {
    frame.data[i] = std::byte{input[3 + i]};
  }
  const unsigned number = frame.id - 0x120U;
  if ((flags & 4U) != 0 && number < dseam::link::kMessageCount) {
    const auto message = static_cast<dseam::link::MessageId>(number);
    if (number == 0) {
      dseam::link::protect_p22(frame.bytes(), dseam::link::data_id_list_of(message),
                               counters[number]++);
    } else {
      dseam::link::protect_p05(frame.bytes(), dseam::link::data_id_of(message), counters[number]++);
    }
  }
  input = input.subspan(3U + frame.size_bytes);
  return frame;
}

void check(const dseam::link::Receiver& robot) {
  const dseam::link::PointStore& points = robot.points();
  const bool sound = points.executed() <= points.verified() &&
                     points.verified() <= points.received() &&
                     points.received() - points.executed() <= points.capacity() &&
                     !(robot.arc_on() && robot.state() != dseam::link::RobotState::kRunning);
  if (!sound) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)dseam::hal::candump::from_line({reinterpret_cast<const char*>(data), size});
  static std::array<std::byte, 1U << 16U> memory;
  dseam::Arena arena(memory);
  const bool classic = size > 0 && (data[0] & 8U) != 0;
  dseam::link::Receiver::Config robot_config;
  dseam::link::Sender::Config host_config;
  robot_config.addressing.classic = classic;
  host_config.addressing.classic = classic;
  auto robot = dseam::link::Receiver::make(robot_config, 64, arena);
  auto host = dseam::link::Sender::make(host_config);
  std::array<Frame, 128> storage;
  dseam::Buffer<Frame> out(storage);
  std::array<std::uint8_t, 16> counters{};
  std::int64_t now_ns = 1'000'000'000;
  (void)host.value().connect(1, now_ns);

  for (Input input(data, size); input.size() > 3; now_ns += 1'000'000) {
    const bool to_host = (input[0] & 1U) != 0;
    const Frame frame = next_frame(input, counters);
    to_host ? host.value().on_frame(frame, now_ns) : robot.value().on_frame(frame, now_ns);
    out.clear();
    robot.value().poll(now_ns, out);
    out.clear();
    host.value().poll(now_ns, out);
    for (dseam::link::DuePoint due; robot.value().take_due(due);) {
    }
    check(robot.value());
  }
  return 0;
}
