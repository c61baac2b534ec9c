// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <thread>

namespace dseam::test {

/// The video output of a vivid instance, joined to its own capture node: what is shown here comes
/// in there, with every bit.
class VividOutput {
 public:
  static constexpr std::uint32_t kWidth = 1280;
  static constexpr std::uint32_t kHeight = 720;

  /// Joins /dev/video`first` (capture) and the next one (output) and plays `image` again and again.
  VividOutput(int first, std::uint32_t fourcc, std::span<const std::byte> image);
  ~VividOutput();
  VividOutput(const VividOutput&) = delete;
  VividOutput& operator=(const VividOutput&) = delete;

  /// Plays another image of the same size from now on; it must stay where it is.
  void show(std::span<const std::byte> image) { image_ = image.data(); }
  /// Nothing was refused so far.
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  static constexpr std::uint32_t kBuffers = 4;

  bool map(std::uint32_t index);
  bool queue(std::uint32_t index);
  void play();

  int fd_;
  std::size_t size_;
  std::atomic<const std::byte*> image_;
  const std::byte* shown_[kBuffers] = {};
  std::byte* places_[kBuffers] = {};
  std::atomic<bool> ok_{false};
  std::atomic<bool> done_{false};
  std::thread thread_;
};

}  // namespace dseam::test
