// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dseam::hal {

/// A camera that a backend can see, whether or not it can be opened.
///
/// Context: set-up and the command line; nothing on a cycle lists cameras.
struct CameraInfo {
  std::string backend;
  std::string id;  ///< What to open it by; the same after a restart or on another socket.
  std::string model;
  std::string address;
  std::string why_not;  ///< Empty when it can be opened; else the reason and what to do about it.
};

}  // namespace dseam::hal
