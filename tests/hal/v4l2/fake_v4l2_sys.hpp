// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "dseam/depth/sample_layout.hpp"
#include "dseam/hal/fake/device_fault.hpp"
#include "dseam/hal/v4l2/v4l2_sys.hpp"

namespace dseam::test {

/// One video device behind the system calls, which does what the kernel's driver `vivid` was seen
/// to do. Any call can be made to fail, and every descriptor and mapping is counted.
class FakeV4l2Sys final : public hal::v4l2::V4l2Sys {
 public:
  struct Setup {
    std::vector<std::uint32_t> formats{depth::fourcc('Y', 'U', 'Y', 'V'),
                                       depth::fourcc('Z', '1', '6', ' ')};
    std::uint32_t width = 32;
    std::uint32_t height = 24;
    std::uint32_t padding_bytes = 0;
    std::uint32_t most_buffers = 32;
    std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    std::int64_t period_ns = 0;  ///< 0: a frame whenever somebody waits for one.
  };

  FakeV4l2Sys() : FakeV4l2Sys(Setup{}) {}
  explicit FakeV4l2Sys(const Setup& setup) : setup_(setup) {}

  /// The n-th call from now on (0 is the next) fails with `error`, once or for ever.
  void fail_call(std::uint64_t n, int error, bool for_ever);
  /// What the frames will be; after the script they are good again.
  void play(std::span<const hal::fake::FaultStep> steps);
  void unplug();
  void plug_in();

  [[nodiscard]] std::uint64_t num_calls() const;
  [[nodiscard]] std::uint64_t num_injected() const;
  [[nodiscard]] std::size_t num_open() const;
  [[nodiscard]] std::size_t num_mapped() const;
  [[nodiscard]] bool script_done() const;

 private:
  struct Buffer {
    std::vector<std::byte> memory;
    bool queued = false;
    bool done = false;
    v4l2_buffer report{};
  };
  struct Connection {
    std::vector<Buffer> buffers;
    std::vector<std::uint32_t> queue;  ///< Waiting for a frame, then done; oldest first.
    std::vector<std::uint32_t> done;
    bool streaming = false;
    bool gone = false;
    std::uint32_t sequence = 0;
    std::int64_t due_ns = 0;
  };

  int open(const char* path) noexcept override;
  int close(int fd) noexcept override;
  int ioctl(int fd, unsigned long request, void* argument) noexcept override;
  int map(int fd, std::size_t size_bytes, std::uint32_t offset, Mapping& out) noexcept override;
  int unmap(const Mapping& mapping) noexcept override;
  int poll(int fd, int timeout_ms) noexcept override;

  [[nodiscard]] int injected();
  int answer(Connection& connection, unsigned long request, void* argument);
  int set_format(v4l2_format& format) const;
  int request_buffers(Connection& connection, v4l2_requestbuffers& request) const;
  int queue(Connection& connection, const v4l2_buffer& buffer);
  int dequeue(Connection& connection, v4l2_buffer& buffer);
  void stream_off(Connection& connection);
  void produce(Connection& connection);
  void expose(Connection& connection);
  void fill(Buffer& buffer, hal::fake::DeviceFault fault, std::uint32_t sequence,
            std::int64_t exposed_ns);
  [[nodiscard]] std::uint32_t line_bytes() const { return 2 * setup_.width + setup_.padding_bytes; }

  Setup setup_;
  mutable std::mutex mutex_;
  std::map<int, Connection> connections_;
  std::map<std::byte*, std::vector<std::byte>> mappings_;
  hal::fake::FaultScript script_;
  bool plugged_ = true;
  int next_fd_ = 100;
  std::uint64_t calls_ = 0;
  std::uint64_t injected_ = 0;
  std::uint64_t fail_at_ = UINT64_MAX;
  int fail_error_ = 0;
  bool fail_for_ever_ = false;
  std::int64_t last_stamp_us_ = 0;
};

}  // namespace dseam::test
