// SPDX-License-Identifier: Apache-2.0
#include "dseam/link/e2e.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/link/channel.hpp"
#include "dseam/link/crc.hpp"

namespace dseam::link {
namespace {

using Bytes = std::vector<std::byte>;

Bytes text(const char* characters) {
  Bytes bytes;
  for (; *characters != '\0'; ++characters) {
    bytes.push_back(static_cast<std::byte>(*characters));
  }
  return bytes;
}

int value(std::byte byte) { return std::to_integer<int>(byte); }

/// 64 bytes of noise, protected.
Bytes protected_frame(std::uint64_t seed) {
  Pcg32 random(seed);
  Bytes frame(64);
  for (std::byte& byte : frame) {
    byte = static_cast<std::byte>(random.below(256));
  }
  protect_p05(frame, 0x1234, 7);
  return frame;
}

void flip(Bytes& frame, std::size_t bit) {
  frame[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
}

TEST(Crc, reproduces_the_published_check_values) {
  const Bytes digits = text("123456789");

  EXPECT_EQ(crc16_ccitt(digits), 0x29B1);
  EXPECT_EQ(crc8_h2f(digits), 0xDF);
  EXPECT_EQ(crc32(digits), 0xCBF43926U);
}

TEST(Crc, may_be_taken_in_pieces) {
  const Bytes all = text("123456789");
  const Bytes head = text("1234");
  const Bytes tail = text("56789");

  EXPECT_EQ(crc16_ccitt(tail, crc16_ccitt(head)), crc16_ccitt(all));
  EXPECT_EQ(crc8_h2f(tail, crc8_h2f(head)), crc8_h2f(all));
  EXPECT_EQ(crc32(tail, crc32(head)), crc32(all));
}

TEST(ProfileFive, reproduces_the_first_autosar_vector) {
  Bytes frame(8);

  protect_p05(frame, 0x1234, 0);

  EXPECT_EQ(value(frame[0]), 0x1C);
  EXPECT_EQ(value(frame[1]), 0xCA);
  EXPECT_TRUE(intact_p05(frame, 0x1234));
}

TEST(ProfileFive, reproduces_the_autosar_vector_with_an_offset) {
  Bytes frame(16);

  protect_p05(frame, 0x1234, 0, 8);

  EXPECT_EQ(value(frame[8]), 0x28);
  EXPECT_EQ(value(frame[9]), 0x91);
  EXPECT_TRUE(intact_p05(frame, 0x1234, 8));
}

TEST(ProfileFive, detects_a_frame_of_another_message) {
  Bytes frame = protected_frame(1);

  EXPECT_TRUE(intact_p05(frame, 0x1234));
  EXPECT_FALSE(intact_p05(frame, 0x1235));
}

TEST(ProfileFive, never_takes_a_frame_shorter_than_its_header) {
  Bytes frame(2);

  protect_p05(frame, 0, 0);

  EXPECT_FALSE(intact_p05(frame, 0));
  EXPECT_FALSE(intact_p05({}, 0));
}

/// The CRC is linear: a pattern is missed in one frame exactly when it is missed in every frame,
/// and the syndrome of a pattern is the sum of the syndromes of its bits.
std::vector<std::uint32_t> syndromes_of_a_64_byte_frame() {
  std::vector<std::uint32_t> syndromes;
  const Bytes clean = protected_frame(2);
  const auto crc_of = [](Bytes frame) {
    const auto low = std::to_integer<std::uint32_t>(frame[0]);
    const auto high = std::to_integer<std::uint32_t>(frame[1]);
    protect_p05(frame, 0x1234, std::to_integer<std::uint8_t>(frame[2]));
    const auto right =
        std::to_integer<std::uint32_t>(frame[0]) | (std::to_integer<std::uint32_t>(frame[1]) << 8U);
    return (low | (high << 8U)) ^ right;
  };
  for (std::size_t bit = 0; bit < clean.size() * 8; ++bit) {
    Bytes damaged = clean;
    flip(damaged, bit);
    syndromes.push_back(crc_of(damaged));
  }
  return syndromes;
}

TEST(ProfileFive, detects_every_flip_of_up_to_three_bits_of_a_64_byte_frame) {
  const std::vector<std::uint32_t> s = syndromes_of_a_64_byte_frame();
  std::uint64_t patterns = 0;
  std::uint64_t missed = 0;

  for (std::size_t a = 0; a < s.size(); ++a) {
    missed += s[a] == 0 ? 1U : 0U;
    ++patterns;
    for (std::size_t b = a + 1; b < s.size(); ++b) {
      missed += (s[a] ^ s[b]) == 0 ? 1U : 0U;
      ++patterns;
      for (std::size_t c = b + 1; c < s.size(); ++c) {
        missed += (s[a] ^ s[b] ^ s[c]) == 0 ? 1U : 0U;
        ++patterns;
      }
    }
  }

  EXPECT_EQ(patterns, 512U + 130'816U + 22'238'720U);
  EXPECT_EQ(missed, 0U);
}

TEST(ProfileFive, the_check_itself_agrees_with_the_syndromes_on_random_patterns) {
  const std::vector<std::uint32_t> s = syndromes_of_a_64_byte_frame();
  Pcg32 random(3);

  for (int i = 0; i < 20'000; ++i) {
    Bytes frame = protected_frame(static_cast<std::uint64_t>(i));
    std::uint32_t syndrome = 0;
    const unsigned flips = 1 + random.below(8);
    for (unsigned k = 0; k < flips; ++k) {
      const std::size_t bit = random.below(512);
      syndrome ^= s[bit];
      flip(frame, bit);
    }
    ASSERT_EQ(intact_p05(frame, 0x1234), syndrome == 0);
  }
}

TEST(ProfileTwentyTwo, reproduces_published_vectors) {
  DataIdList ids;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    ids[i] = static_cast<std::uint8_t>(i + 1);
  }
  const std::vector<std::pair<std::uint8_t, int>> vectors = {{1, 0x1B}, {2, 0x98}, {3, 0x31}};

  for (const auto& [counter, crc] : vectors) {
    Bytes frame(8);
    protect_p22(frame, ids, counter);
    EXPECT_EQ(value(frame[0]), crc) << int{counter};
    EXPECT_EQ(value(frame[1]), counter);
    EXPECT_TRUE(intact_p22(frame, ids));
  }
}

TEST(ProfileTwentyTwo, detects_every_flip_of_up_to_three_bits_of_a_classic_frame) {
  const DataIdList ids = data_id_list_of(MessageId::kPoint);
  std::uint64_t missed = 0;

  for (std::uint8_t counter = 0; counter < 16; ++counter) {
    Bytes clean(8, std::byte{0xA5});
    protect_p22(clean, ids, counter);
    for (std::size_t a = 0; a < 64; ++a) {
      for (std::size_t b = a; b < 64; ++b) {
        for (std::size_t c = b; c < 64; ++c) {
          Bytes frame = clean;
          flip(frame, a);
          if (b != a) {
            flip(frame, b);
          }
          if (c != b) {
            flip(frame, c);
          }
          missed += intact_p22(frame, ids) ? 1U : 0U;
        }
      }
    }
  }

  EXPECT_EQ(missed, 0U);
}

TEST(CounterCheck, names_every_jump_of_the_counter) {
  for (unsigned from = 0; from < 256; ++from) {
    for (unsigned to = 0; to < 256; ++to) {
      CounterCheck check(256, 4);
      ASSERT_EQ(check.check(true, static_cast<std::uint8_t>(from)), E2eStatus::kOk);
      const unsigned delta = (to + 256 - from) % 256;
      const E2eStatus expected = delta == 0   ? E2eStatus::kRepeated
                                 : delta == 1 ? E2eStatus::kOk
                                 : delta <= 4 ? E2eStatus::kOkSomeLost
                                              : E2eStatus::kWrongSequence;
      ASSERT_EQ(check.check(true, static_cast<std::uint8_t>(to)), expected);
    }
  }
}

TEST(CounterCheck, a_damaged_frame_does_not_move_the_counter) {
  CounterCheck check(256, 4);
  (void)check.check(true, 10);

  EXPECT_EQ(check.check(false, 200), E2eStatus::kError);
  EXPECT_EQ(check.check(true, 11), E2eStatus::kOk);
}

TEST(E2eWindow, becomes_valid_after_three_whole_frames) {
  E2eWindow window;

  EXPECT_EQ(window.add(E2eStatus::kOk), E2eState::kInit);
  EXPECT_EQ(window.add(E2eStatus::kOkSomeLost), E2eState::kInit);
  EXPECT_EQ(window.add(E2eStatus::kOk), E2eState::kValid);
}

TEST(E2eWindow, two_damaged_frames_in_ten_are_borne_and_three_are_not) {
  E2eWindow window;
  for (int i = 0; i < 8; ++i) {
    window.add(E2eStatus::kOk);
  }

  EXPECT_EQ(window.add(E2eStatus::kError), E2eState::kValid);
  EXPECT_EQ(window.add(E2eStatus::kError), E2eState::kValid);
  EXPECT_EQ(window.add(E2eStatus::kError), E2eState::kInvalid);
}

TEST(E2eWindow, a_stream_of_repetitions_is_not_valid_for_long) {
  E2eWindow window;
  for (int i = 0; i < 3; ++i) {
    window.add(E2eStatus::kOk);
  }

  for (std::size_t i = 0; i < E2eWindow::kWindow; ++i) {
    window.add(E2eStatus::kRepeated);
  }

  EXPECT_EQ(window.state(), E2eState::kInvalid);
}

}  // namespace
}  // namespace dseam::link
