// SPDX-License-Identifier: Apache-2.0
// What the fake device sees, and when.
#include <algorithm>
#include <chrono>

#include "hal/v4l2/fake_v4l2_sys.hpp"

namespace dseam::test {
namespace {

using hal::fake::DeviceFault;

std::int64_t now_ns() { return std::chrono::steady_clock::now().time_since_epoch().count(); }

}  // namespace

void FakeV4l2Sys::produce(Connection& connection) {
  if (!connection.streaming) {
    return;
  }
  if (setup_.period_ns == 0) {
    if (connection.done.empty()) {
      expose(connection);
    }
    return;
  }
  while (connection.due_ns <= now_ns()) {
    expose(connection);
    connection.due_ns += setup_.period_ns;
  }
}

void FakeV4l2Sys::expose(Connection& connection) {
  const auto turn =
      script_.done() ? hal::fake::FaultScript::Turn{DeviceFault::kNone, 0} : script_.next();
  connection.sequence += turn.fault == DeviceFault::kStuck ? 0U : 1U;
  if (turn.fault == DeviceFault::kUnplugged) {
    connection.gone = true;
    return;
  }
  const bool nothing = turn.fault == DeviceFault::kOff || turn.fault == DeviceFault::kLost ||
                       (turn.fault == DeviceFault::kIntermittent && turn.index % 2 == 1);
  if (nothing || connection.queue.empty()) {
    return;
  }
  const std::uint32_t index = connection.queue.front();
  connection.queue.erase(connection.queue.begin());
  connection.done.push_back(index);
  fill(connection.buffers[index], turn.fault, connection.sequence,
       setup_.period_ns == 0 ? now_ns() : connection.due_ns);
}

void FakeV4l2Sys::fill(Buffer& buffer, DeviceFault fault, std::uint32_t sequence,
                       std::int64_t exposed_ns) {
  const std::uint32_t size = line_bytes() * setup_.height;
  const auto address = buffer.report.m.userptr;
  auto* bytes = reinterpret_cast<std::byte*>(address);  // NOLINT: see map().
  if (mappings_.contains(bytes)) {
    std::fill_n(bytes, size, std::byte(sequence));
  }
  std::int64_t stamp_us = exposed_ns / 1000;
  stamp_us += fault == DeviceFault::kClockJump ? 3'600'000'000 : 0;
  stamp_us -= fault == DeviceFault::kDelayed ? 500'000 : 0;
  stamp_us = fault == DeviceFault::kStuck ? last_stamp_us_ : stamp_us;
  last_stamp_us_ = stamp_us;
  v4l2_buffer report{};
  report.m.userptr = address;
  report.length = size;
  report.sequence = sequence;
  report.bytesused = fault == DeviceFault::kTruncated ? size / 2 : size;
  report.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  report.flags |= fault == DeviceFault::kGarbage ? V4L2_BUF_FLAG_ERROR : 0U;
  report.timestamp.tv_sec = stamp_us / 1'000'000;
  report.timestamp.tv_usec = stamp_us % 1'000'000;
  if (fault == DeviceFault::kWrong) {
    report.bytesused = size + 4096;
  }
  buffer.report = report;
}

}  // namespace dseam::test
