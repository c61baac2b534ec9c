// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "dseam/hal/socketcan/can_socket.hpp"
#include "dseam/link/channel.hpp"

namespace dseam::program {

/// As long as it lives, a signal that ends or breaks this process first sends the weld link's
/// abort.
class LastWords {
 public:
  /// On `interface`, in addition to what others watch these signals for.
  ///
  /// Errors:  throws Failure(kDevice) where the interface or the handlers are refused.
  LastWords(const std::string& interface, const link::Addressing& addressing);
  ~LastWords();
  LastWords(const LastWords&) = delete;
  LastWords& operator=(const LastWords&) = delete;

  /// The abort as the kernel takes it: it counts for whatever session the robot is in.
  static std::array<std::byte, 16> abort_frame(const link::Addressing& addressing);

 private:
  hal::socketcan::CanSocket socket_;
};

}  // namespace dseam::program
