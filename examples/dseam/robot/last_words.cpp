// SPDX-License-Identifier: Apache-2.0
#include "robot/last_words.hpp"

#include <linux/can.h>

#include <bit>
#include <cstring>

#include "dseam/link/codec.hpp"
#include "dseam/rt/linux/last_gasp.hpp"
#include "failure.hpp"

namespace dseam::program {

LastWords::LastWords(const std::string& interface, const link::Addressing& addressing)
    : socket_(hal::socketcan::linux_can_sys()) {
  const auto frame = abort_frame(addressing);
  // A socket for error frames: it hears next to nothing, so that nothing piles up in it.
  if (!socket_.open_for_errors(interface).ok() || !rt::last_gasp::install().ok() ||
      !rt::last_gasp::prepare(socket_.fd(), frame).ok()) {
    throw Failure(ExitCode::kDevice, "can:" + interface + ": no last words can be prepared");
  }
}

LastWords::~LastWords() { rt::last_gasp::disarm(); }

std::array<std::byte, 16> LastWords::abort_frame(const link::Addressing& addressing) {
  static_assert(sizeof(can_frame) == 16);
  std::array<link::Frame, 1> storage;
  Buffer<link::Frame> out(storage);
  const link::Abort abort{.session = 0, .reason = link::Fault::kAborted};
  (void)link::Transmitter(addressing).send(link::MessageId::kAbort, encode(abort), out);
  can_frame raw{};
  raw.can_id = storage[0].id;
  raw.can_dlc = storage[0].size_bytes;
  std::memcpy(raw.data, storage[0].data.data(), raw.can_dlc);
  return std::bit_cast<std::array<std::byte, 16>>(raw);
}

}  // namespace dseam::program
