// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/candump/candump_format.hpp"

#include <gtest/gtest.h>

#include "dseam/base/random.hpp"

namespace dseam::hal::candump {
namespace {

TEST(CandumpFormat, writes_what_candump_writes) {
  CanFrame classic;
  classic.id = 0x120;
  classic.size_bytes = 2;
  classic.data = {std::byte{0xAB}, std::byte{0x01}};
  classic.stamp_ns = 1'436'509'052'249'713'000;
  CanFrame fd = classic;
  fd.fd = true;

  EXPECT_EQ(to_line(classic, "vcan0"), "(1436509052.249713) vcan0 120#AB01");
  EXPECT_EQ(to_line(fd, "vcan0"), "(1436509052.249713) vcan0 120##1AB01");
}

TEST(CandumpFormat, reads_back_what_it_wrote) {
  Pcg32 random(1);
  constexpr std::array<std::uint8_t, 16> kSizes = {0, 1,  2,  3,  4,  5,  6,  7,
                                                   8, 12, 16, 20, 24, 32, 48, 64};
  for (int i = 0; i < 2000; ++i) {
    CanFrame frame;
    frame.fd = random.below(2) == 1;
    frame.extended = random.below(2) == 1;
    frame.id = random.next() & (frame.extended ? 0x1FFF'FFFFU : 0x7FFU);
    frame.size_bytes = kSizes[random.below(frame.fd ? 16 : 9)];
    frame.stamp_ns = std::int64_t{random.next()} * 1000;
    for (std::size_t k = 0; k < frame.size_bytes; ++k) {
      frame.data[k] = static_cast<std::byte>(random.below(256));
    }

    const Result<CanFrame> read = from_line(to_line(frame, "can0"));

    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read.value().id, frame.id);
    EXPECT_EQ(read.value().fd, frame.fd);
    EXPECT_EQ(read.value().extended, frame.extended);
    EXPECT_EQ(read.value().size_bytes, frame.size_bytes);
    EXPECT_EQ(read.value().data, frame.data);
    EXPECT_EQ(read.value().stamp_ns, frame.stamp_ns);
  }
}

TEST(CandumpFormat, names_every_line_that_is_none) {
  for (const char* line :
       {"", "(", "()", "(1.5) can0 120#", "(1.000000)can0 120#", "(1.000000) 120#",
        "(1.000000) can0 120", "(1.000000) can0 12#", "(1.000000) can0 120#A",
        "(1.000000) can0 120#0G", "(1.000000) can0 120##", "(1.000000) can0 800#",
        "(1.000000) can0 120#000000000000000000", "(1.000000) can0 120##1000000000000000000",
        "(99999999999999999999.000000) can0 120#", "(-1.000000) can0 120#"}) {
    EXPECT_FALSE(from_line(line).ok()) << line;
  }
}

}  // namespace
}  // namespace dseam::hal::candump
