// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "dseam/hal/socketcan/socketcan_bus.hpp"
#include "hal/socketcan/fake_kernel.hpp"

namespace dseam::test {

inline hal::CanFrame frame_of(std::uint32_t id, std::uint8_t size = 8) {
  hal::CanFrame frame;
  frame.id = id;
  frame.fd = true;
  frame.size_bytes = size;
  return frame;
}

/// Buses on the interface of a fake kernel.
class SocketCan : public ::testing::Test {
 protected:
  using Bus = hal::socketcan::SocketCanBus;

  std::unique_ptr<Bus> open(const Bus::Config& config = {}) {
    auto opened = Bus::open("can0", config, kernel_);
    EXPECT_TRUE(opened.ok());
    return opened.ok() ? std::move(opened.value()) : nullptr;
  }
  Errc open_error(const Bus::Config& config = {}) {
    const auto opened = Bus::open("can0", config, kernel_);
    return opened.ok() ? Errc::kInvalidArgument : opened.error();
  }

  FakeKernel kernel_;
};

}  // namespace dseam::test
