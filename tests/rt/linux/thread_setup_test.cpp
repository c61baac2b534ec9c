// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/linux/thread_setup.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <string>
#include <thread>

#include "dseam/rt/linux/rt_report.hpp"

namespace {

using dseam::rt::Policy;
using dseam::rt::RtReport;
using dseam::rt::RtSys;
using dseam::rt::ThreadConfig;
using dseam::rt::ThreadReport;

int grant() noexcept { return 0; }
int refuse() noexcept { return EPERM; }
int grant_fifo(int) noexcept { return 0; }
int refuse_fifo(int) noexcept { return EPERM; }
int grant_deadline(std::uint64_t, std::uint64_t, std::uint64_t) noexcept { return 0; }
int refuse_deadline(std::uint64_t, std::uint64_t, std::uint64_t) noexcept { return EBUSY; }
int refuse_cpu(int) noexcept { return EINVAL; }

constexpr RtSys kGranting{grant, grant_fifo, grant_deadline, grant_fifo};

TEST(ThreadSetup, is_real_time_when_all_is_granted) {
  EXPECT_TRUE(set_up_thread({}, kGranting).value().real_time());
  EXPECT_TRUE(
      set_up_thread({.policy = Policy::kDeadline, .cpu = 0}, kGranting).value().real_time());
}

TEST(ThreadSetup, each_refusal_is_reported_and_the_rest_is_still_done) {
  RtSys no_memory = kGranting;
  no_memory.lock_memory = refuse;
  RtSys no_fifo = kGranting;
  no_fifo.set_fifo = refuse_fifo;
  RtSys no_deadline = kGranting;
  no_deadline.set_deadline = refuse_deadline;
  RtSys no_cpu = kGranting;
  no_cpu.pin_to_cpu = refuse_cpu;

  EXPECT_EQ(set_up_thread({}, no_memory).value().memory_error, EPERM);
  EXPECT_EQ(set_up_thread({}, no_memory).value().policy_error, 0);
  EXPECT_EQ(set_up_thread({}, no_fifo).value().policy_error, EPERM);
  EXPECT_EQ(set_up_thread({.policy = Policy::kDeadline}, no_deadline).value().policy_error, EBUSY);
  EXPECT_EQ(set_up_thread({.cpu = 1000}, no_cpu).value().cpu_error, EINVAL);
  EXPECT_FALSE(set_up_thread({}, no_memory).value().real_time());
}

TEST(ThreadSetup, the_ordinary_policy_is_never_real_time) {
  EXPECT_FALSE(set_up_thread({.policy = Policy::kOther}, kGranting).value().real_time());
}

TEST(ThreadSetup, what_cannot_be_is_refused) {
  EXPECT_FALSE(set_up_thread({.priority = 0}, kGranting).ok());
  EXPECT_FALSE(set_up_thread({.priority = 99}, kGranting).ok());
  EXPECT_FALSE(set_up_thread({.policy = Policy::kDeadline, .runtime_ns = 0}, kGranting).ok());
  EXPECT_FALSE(set_up_thread({.policy = Policy::kDeadline, .period_ns = 1}, kGranting).ok());
  EXPECT_FALSE(set_up_thread({.cpu = 1'000'000}, kGranting).ok());
}

TEST(ThreadSetup, the_real_calls_answer_whatever_they_say) {
  std::thread thread([] {
    const auto fifo = dseam::rt::set_up_thread({.cpu = 0, .lock_memory = false});
    const auto deadline =
        dseam::rt::set_up_thread({.policy = Policy::kDeadline, .lock_memory = false});
    EXPECT_TRUE(fifo.ok());
    EXPECT_TRUE(deadline.ok());
    EXPECT_NE(dseam::rt::set_up_thread({.cpu = 1023, .lock_memory = false}).value().cpu_error, 0);
  });
  thread.join();
}

TEST(RtReport, tells_of_this_machine_and_names_the_cure_for_what_was_refused) {
  const RtReport report = dseam::rt::rt_report({.memory_error = EPERM, .policy_error = EPERM});
  std::string text(2048, '\0');

  text.resize(format(report, text));

  EXPECT_GT(report.processors, 0);
  EXPECT_NE(text.find("CAP_IPC_LOCK"), std::string::npos);
  EXPECT_NE(text.find("CAP_SYS_NICE"), std::string::npos);
  EXPECT_NE(text.find("DEGRADED"), std::string::npos);
  EXPECT_FALSE(report.ready());
}

TEST(RtReport, a_small_page_is_filled_and_not_overrun) {
  const RtReport report = dseam::rt::rt_report({});
  std::string text(40, 'x');

  const std::size_t size = format(report, std::span(text.data(), 30));

  EXPECT_EQ(size, 29U);
  EXPECT_EQ(text.substr(30), std::string(10, 'x'));
  EXPECT_EQ(format(report, {}), 0U);
}

}  // namespace
