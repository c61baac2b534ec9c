// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/socketcan/link_check.hpp"

#include <gtest/gtest.h>

#include "dseam/base/random.hpp"

namespace dseam::hal::socketcan {
namespace {

LinkInfo good_can() { return {true, "can", 72, 128, 1'000'000, 5'000'000, 0, 0}; }

TEST(LinkCheck, the_kernel_answers_about_an_interface_every_machine_has) {
  const auto info = read_link("lo");

  ASSERT_TRUE(info.ok());
  EXPECT_GT(info.value().mtu, 1000U);
  EXPECT_EQ(read_link("none-such0").error(), Errc::kNotFound);
}

TEST(LinkCheck, an_interface_that_is_no_bus_is_refused) {
  const auto findings = judge_link("lo", read_link("lo").value(), {});

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_TRUE(findings[0].refuse);
}

TEST(LinkCheck, a_well_configured_bus_gives_no_remark) {
  EXPECT_TRUE(judge_link("can0", good_can(), {true, 1'000'000, 5'000'000, 16}).empty());
}

TEST(LinkCheck, each_fault_is_named_with_its_cure) {
  struct Case {
    void (*spoil)(LinkInfo&);
    bool refuse;
    const char* cure;
  };
  const Case cases[] = {
      {[](LinkInfo& info) { info.up = false; }, true, "up"},
      {[](LinkInfo& info) { info.mtu = 16; }, true, "fd on"},
      {[](LinkInfo& info) { info.bits_per_s = 500'000; }, true, "bitrate 1000000"},
      {[](LinkInfo& info) { info.data_bits_per_s = 2'000'000; }, true, "dbitrate 5000000"},
      {[](LinkInfo& info) { info.restart_ms = 100; }, false, "restart-ms 0"},
      {[](LinkInfo& info) { info.queue_frames = 10; }, false, "txqueuelen 16"},
  };
  for (const Case& one : cases) {
    LinkInfo info = good_can();
    one.spoil(info);

    const auto findings = judge_link("can0", info, {true, 1'000'000, 5'000'000, 16});

    ASSERT_EQ(findings.size(), 1U) << one.cure;
    EXPECT_EQ(findings[0].refuse, one.refuse) << one.cure;
    EXPECT_NE(findings[0].cure.find(one.cure), std::string::npos) << findings[0].cure;
  }
}

TEST(LinkCheck, an_answer_that_is_damaged_is_never_read_out_of_bounds) {
  Pcg32 random(1);
  for (int i = 0; i < 100'000; ++i) {
    std::vector<std::byte> answer(random.below(120));
    for (std::byte& byte : answer) {
      byte = static_cast<std::byte>(random.below(random.below(3) == 0 ? 256 : 24));
    }
    if (answer.size() >= 6) {
      answer[0] = static_cast<std::byte>(answer.size());
      answer[1] = answer[2] = answer[3] = std::byte{0};
      answer[4] = std::byte{16};  // RTM_NEWLINK
      answer[5] = std::byte{0};
    }
    (void)parse_link(answer);
  }
}

}  // namespace
}  // namespace dseam::hal::socketcan
