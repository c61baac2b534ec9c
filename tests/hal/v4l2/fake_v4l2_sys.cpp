// SPDX-License-Identifier: Apache-2.0
#include "hal/v4l2/fake_v4l2_sys.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

namespace dseam::test {
namespace {

std::int64_t now_ns() { return std::chrono::steady_clock::now().time_since_epoch().count(); }

}  // namespace

void FakeV4l2Sys::fail_call(std::uint64_t n, int error, bool for_ever) {
  const std::lock_guard lock(mutex_);
  fail_at_ = calls_ + n;
  fail_error_ = error;
  fail_for_ever_ = for_ever;
}

void FakeV4l2Sys::play(std::span<const hal::fake::FaultStep> steps) {
  const std::lock_guard lock(mutex_);
  script_ = hal::fake::FaultScript(steps);
}

void FakeV4l2Sys::unplug() {
  const std::lock_guard lock(mutex_);
  plugged_ = false;
  for (auto& [fd, connection] : connections_) {
    connection.gone = true;
  }
}

void FakeV4l2Sys::plug_in() {
  const std::lock_guard lock(mutex_);
  plugged_ = true;
}

std::uint64_t FakeV4l2Sys::num_calls() const {
  const std::lock_guard lock(mutex_);
  return calls_;
}

std::uint64_t FakeV4l2Sys::num_injected() const {
  const std::lock_guard lock(mutex_);
  return injected_;
}

std::size_t FakeV4l2Sys::num_open() const {
  const std::lock_guard lock(mutex_);
  return connections_.size();
}

std::size_t FakeV4l2Sys::num_mapped() const {
  const std::lock_guard lock(mutex_);
  return mappings_.size();
}

bool FakeV4l2Sys::script_done() const {
  const std::lock_guard lock(mutex_);
  return script_.done();
}

/// The error that this call is to fail with, 0 for none.
int FakeV4l2Sys::injected() {
  const std::uint64_t call = calls_++;
  const bool fails = call == fail_at_ || (fail_for_ever_ && call > fail_at_);
  injected_ += fails ? 1U : 0U;
  return fails ? fail_error_ : 0;
}

int FakeV4l2Sys::open(const char* path) noexcept {
  const std::lock_guard lock(mutex_);
  if (const int error = injected(); error != 0) {
    return -error;
  }
  if (!plugged_ || std::strcmp(path, "/dev/video0") != 0) {
    return -ENOENT;
  }
  connections_[next_fd_] = {};
  return next_fd_++;
}

/// Linux closes the descriptor whatever close() says.
int FakeV4l2Sys::close(int fd) noexcept {
  const std::lock_guard lock(mutex_);
  const int error = injected();
  return connections_.erase(fd) == 1 ? -error : -EBADF;
}

int FakeV4l2Sys::ioctl(int fd, unsigned long request, void* argument) noexcept {
  const std::lock_guard lock(mutex_);
  if (const int error = injected(); error != 0) {
    return -error;
  }
  const auto found = connections_.find(fd);
  if (found == connections_.end()) {
    return -EBADF;
  }
  return found->second.gone ? -ENODEV : answer(found->second, request, argument);
}

int FakeV4l2Sys::answer(Connection& connection, unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& capability = *static_cast<v4l2_capability*>(argument);
      std::memcpy(capability.card, "fake", 5);
      std::memcpy(capability.bus_info, "test:0", 7);
      capability.capabilities = V4L2_CAP_DEVICE_CAPS | setup_.capabilities;
      capability.device_caps = setup_.capabilities;
      return 0;
    }
    case VIDIOC_G_FMT:
    case VIDIOC_S_FMT:
      return set_format(*static_cast<v4l2_format*>(argument));
    case VIDIOC_ENUM_FMT: {
      auto& description = *static_cast<v4l2_fmtdesc*>(argument);
      if (description.index >= setup_.formats.size()) {
        return -EINVAL;
      }
      description.pixelformat = setup_.formats[description.index];
      return 0;
    }
    case VIDIOC_REQBUFS:
      return request_buffers(connection, *static_cast<v4l2_requestbuffers*>(argument));
    case VIDIOC_QUERYBUF: {
      auto& buffer = *static_cast<v4l2_buffer*>(argument);
      buffer.length = line_bytes() * setup_.height;
      buffer.m.offset = buffer.index << 12U;
      return buffer.index < connection.buffers.size() ? 0 : -EINVAL;
    }
    case VIDIOC_QBUF:
      return queue(connection, *static_cast<v4l2_buffer*>(argument));
    case VIDIOC_DQBUF:
      return dequeue(connection, *static_cast<v4l2_buffer*>(argument));
    case VIDIOC_STREAMON:
      connection.streaming = true;
      connection.due_ns = now_ns() + setup_.period_ns;
      return 0;
    case VIDIOC_STREAMOFF:
      stream_off(connection);
      return 0;
    default:
      return -ENOTTY;
  }
}

/// As vivid: a format that it has not becomes its first one, without an error.
int FakeV4l2Sys::set_format(v4l2_format& format) const {
  v4l2_pix_format& pixels = format.fmt.pix;
  const bool known = std::find(setup_.formats.begin(), setup_.formats.end(), pixels.pixelformat) !=
                     setup_.formats.end();
  pixels.pixelformat = known ? pixels.pixelformat : setup_.formats.front();
  pixels.width = setup_.width;
  pixels.height = setup_.height;
  pixels.bytesperline = line_bytes();
  pixels.sizeimage = line_bytes() * setup_.height;
  return 0;
}

int FakeV4l2Sys::request_buffers(Connection& connection, v4l2_requestbuffers& request) const {
  request.count = std::min(request.count, setup_.most_buffers);
  connection.buffers.resize(request.count);
  connection.queue.reserve(request.count);
  connection.done.reserve(request.count);
  for (Buffer& buffer : connection.buffers) {
    buffer.memory.resize(std::size_t{line_bytes()} * setup_.height);
  }
  return 0;
}

int FakeV4l2Sys::queue(Connection& connection, const v4l2_buffer& buffer) {
  if (buffer.index >= connection.buffers.size() || connection.buffers[buffer.index].queued) {
    return -EINVAL;
  }
  connection.buffers[buffer.index].queued = true;
  connection.queue.push_back(buffer.index);
  return 0;
}

int FakeV4l2Sys::dequeue(Connection& connection, v4l2_buffer& buffer) {
  if (!connection.streaming) {
    return -EINVAL;
  }
  if (setup_.period_ns != 0) {
    produce(connection);
  }
  if (connection.done.empty()) {
    return -EAGAIN;
  }
  const std::uint32_t index = connection.done.front();
  connection.done.erase(connection.done.begin());
  connection.buffers[index].queued = false;
  buffer = connection.buffers[index].report;
  buffer.index = index;
  return 0;
}

void FakeV4l2Sys::stream_off(Connection& connection) {
  connection.streaming = false;
  connection.queue.clear();
  connection.done.clear();
  for (Buffer& buffer : connection.buffers) {
    buffer.queued = false;
  }
}

/// Memory of its own, which stays when the descriptor is closed, as the kernel's does.
int FakeV4l2Sys::map(int fd, std::size_t size_bytes, std::uint32_t offset, Mapping& out) noexcept {
  const std::lock_guard lock(mutex_);
  if (const int error = injected(); error != 0) {
    return -error;
  }
  const auto found = connections_.find(fd);
  if (found == connections_.end() || found->second.gone) {
    return -ENODEV;
  }
  std::vector<std::byte> memory(size_bytes);
  out = {memory.data(), size_bytes};
  // The driver's end of the buffer is found by its index.
  found->second.buffers[offset >> 12U].report.m.userptr =
      reinterpret_cast<unsigned long>(out.start);  // NOLINT: an address kept in the kernel's type.
  mappings_[out.start] = std::move(memory);
  return 0;
}

int FakeV4l2Sys::unmap(const Mapping& mapping) noexcept {
  const std::lock_guard lock(mutex_);
  const int error = injected();  // Nobody can do anything about it; the mapping goes all the same.
  return mappings_.erase(mapping.start) == 1 ? -error : -EINVAL;
}

int FakeV4l2Sys::poll(int fd, int timeout_ms) noexcept {
  std::unique_lock lock(mutex_);
  if (const int error = injected(); error != 0) {
    return -error;
  }
  const auto found = connections_.find(fd);
  if (found == connections_.end() || found->second.gone) {
    return POLLERR | POLLHUP;
  }
  produce(found->second);
  if (!found->second.done.empty()) {
    return POLLIN;
  }
  lock.unlock();
  std::this_thread::sleep_for(std::chrono::milliseconds(std::min(timeout_ms, 1)));
  return 0;
}

}  // namespace dseam::test
