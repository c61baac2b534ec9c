// SPDX-License-Identifier: Apache-2.0
// Bursts on every message, exhaustively. Profile 5 stores its CRC little endian in front of the
// data, so that a few bursts across the header (14 at 64 bytes) fulfil the CRC: what stands behind
// refuses them.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "dseam/link/classic.hpp"
#include "dseam/link/crc.hpp"
#include "lib/link/bursts.hpp"

namespace dseam::link {
namespace {

class Burst : public ::testing::TestWithParam<MessageId> {};

INSTANTIATE_TEST_SUITE_P(Messages, Burst,
                         ::testing::Values(MessageId::kCommand, MessageId::kStatus,
                                           MessageId::kTrajectory, MessageId::kNack,
                                           MessageId::kPoint, MessageId::kPose,
                                           MessageId::kHelloHost, MessageId::kHelloRobot));

/// For every value of the counter, as the decision depends on it.
TEST_P(Burst, no_burst_of_up_to_16_bits_changes_what_is_acted_upon) {
  std::vector<Frame> storage(300);
  Buffer<Frame> frames(storage);
  Transmitter transmitter({});
  for (int i = 0; i < 257; ++i) {
    ASSERT_TRUE(transmitter.send(GetParam(), payload_of(GetParam()), frames));
  }
  const auto missed = missed_by_crc(frames[1], [](Frame& frame) {
    protect_p05(frame.bytes(), data_id_of(GetParam()), counter_p05(frame.bytes()));
  });

  for (const auto& [start, pattern] : missed) {
    for (std::size_t i = 1; i < frames.size(); ++i) {
      Acceptor acceptor({});
      (void)acceptor.accept(frames[i - 1]);
      const Frame damaged = burst(frames[i], start, pattern);
      const auto accepted = acceptor.accept(damaged);
      ASSERT_TRUE(accepted.has_value());
      if (!usable(accepted->status) || !decodes(*accepted)) {
        continue;
      }
      const bool unchanged =
          std::equal(damaged.data.begin() + 3, damaged.data.end(), frames[i].data.begin() + 3);
      const bool refused_by_mark =
          GetParam() == MessageId::kPoint &&
          crc32(covered_by_crc(damaged)) != crc32(covered_by_crc(frames[i]));
      EXPECT_TRUE(unchanged || refused_by_mark) << start << " " << pattern << " " << i;
    }
  }
}

/// The message that comes out of its segments when segment `at` is damaged; of two messages, so
/// that the counters are known. Nothing where it is dropped.
std::optional<Accepted> joined(const Buffer<Frame>& segments, std::size_t first, std::size_t count,
                               std::size_t at, const Frame& damaged) {
  Addressing classic;
  classic.classic = true;
  Acceptor acceptor(classic);
  std::optional<Accepted> whole;
  for (std::size_t k = first - count; k < first + count; ++k) {
    const auto accepted = acceptor.accept(k == first + at ? damaged : segments[k]);
    whole = k >= first && accepted && usable(accepted->status) ? accepted : whole;
    whole = k < first ? std::nullopt : whole;
  }
  return whole;
}

/// On a classic bus a CRC of 8 bits guards each segment and one of 16 bits the whole.
TEST_P(Burst, no_burst_of_up_to_16_bits_on_a_segment_changes_what_is_acted_upon) {
  constexpr std::size_t kMessages = 17;  // Every value of the segments' counter.
  Addressing classic;
  classic.classic = true;
  std::vector<Frame> storage(kMessages * kMaxSegments);
  Buffer<Frame> segments(storage);
  Transmitter transmitter(classic);
  for (std::size_t i = 0; i < kMessages; ++i) {
    ASSERT_TRUE(transmitter.send(GetParam(), payload_of(GetParam()), segments));
  }
  const std::size_t count = segments.size() / kMessages;
  std::size_t tried = 0;
  for (std::size_t at = 0; at < count; ++at) {
    const auto missed = missed_by_crc(segments[at], [](Frame& frame) {
      protect_p22(frame.bytes(), data_id_list_of(GetParam()), counter_p22(frame.bytes()));
    });
    for (std::size_t i = 1; i < kMessages; ++i) {
      const std::size_t first = i * count;
      const auto truth = joined(segments, first, count, at, segments[first + at]);
      ASSERT_TRUE(truth.has_value());
      for (const auto& [start, pattern] : missed) {
        ++tried;
        const Frame damaged = burst(segments[first + at], start, pattern);
        const auto whole = joined(segments, first, count, at, damaged);
        if (!whole || !decodes(*whole)) {
          continue;
        }
        const Frame& got = whole->payload;
        const Frame& sent = truth->payload;
        const bool unchanged =
            std::equal(got.data.begin() + 3, got.data.end(), sent.data.begin() + 3);
        const bool refused_by_mark = GetParam() == MessageId::kPoint &&
                                     crc32(covered_by_crc(got)) != crc32(covered_by_crc(sent));
        EXPECT_TRUE(unchanged || refused_by_mark) << at << " " << start << " " << pattern;
      }
    }
  }
  EXPECT_GT(tried, 10'000U);
}

}  // namespace
}  // namespace dseam::link
