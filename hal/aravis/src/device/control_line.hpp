// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <span>

#include "device/own_sockets.hpp"

namespace dseam::hal::aravis {

/// The socket through which Aravis speaks to a GigE Vision camera, held so that it can be cut.
///
/// Aravis waits 2.5 s for each answer of a camera that is gone, and to let go of one it asks five
/// times: 12.5 s. It has no call to end that, but a socket that may not send any more fails each
/// access at once.
class ControlLine {
 public:
  ControlLine() = default;
  ControlLine(const ControlLine&) = delete;
  ControlLine& operator=(const ControlLine&) = delete;
  ~ControlLine() { release(); }

  /// Holds the one socket that is not among `before`. None when there are several: then it is not
  /// known which is Aravis', and a close waits for the answers.
  void hold_the_new_one(std::span<const OwnSocket> before);
  void release() noexcept;
  /// From now on every access to this camera fails, and to each that is held later.
  ///
  /// Context: any thread, also while another is in an access; that one ends within 0.5 s.
  void cut() noexcept;

 private:
  std::mutex mutex_;
  int fd_ = -1;
  bool cut_ = false;
};

}  // namespace dseam::hal::aravis
