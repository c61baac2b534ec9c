// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/arc_gate.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace {

using dseam::hal::BusState;
using dseam::rt::ArcGate;
using dseam::rt::ArcInputs;
using dseam::rt::Fault;
using dseam::seam::Confidence;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ArcInputs all_well() {
  ArcInputs in;
  in.armed = true;
  in.confidence = Confidence::kMedium;
  in.bus = BusState::kErrorActive;
  in.speed_mm_s = 8.0;
  in.planned_low_mm_s = 8.0;
  in.planned_high_mm_s = 8.0;
  return in;
}

struct Loss {
  const char* name;
  std::function<void(ArcInputs&)> lose;
  Fault fault;
};

const std::vector<Loss>& losses() {
  static const std::vector<Loss> all = {
      {"disarmed", [](ArcInputs& in) { in.armed = false; }, Fault::kNotArmed},
      {"old data", [](ArcInputs& in) { in.data_age_ns = 20'000'001; }, Fault::kDataStale},
      {"old pose", [](ArcInputs& in) { in.pose_age_ns = 60'000'001; }, Fault::kDataStale},
      {"doubt", [](ArcInputs& in) { in.confidence = Confidence::kNone; }, Fault::kConfidenceLow},
      {"stream", [](ArcInputs& in) { in.stream_age_ns = 100'000'001; }, Fault::kStreamStopped},
      {"passive", [](ArcInputs& in) { in.bus = BusState::kErrorPassive; }, Fault::kBusNotActive},
      {"bus off", [](ArcInputs& in) { in.bus = BusState::kBusOff; }, Fault::kBusNotActive},
      {"down", [](ArcInputs& in) { in.bus = BusState::kDown; }, Fault::kBusNotActive},
      {"tracking", [](ArcInputs& in) { in.tracking_mm = 5.01; }, Fault::kTrackingError},
      {"tracking nan", [](ArcInputs& in) { in.tracking_mm = kNan; }, Fault::kTrackingError},
      {"slow", [](ArcInputs& in) { in.speed_mm_s = 2.9; }, Fault::kSpeedOutOfWindow},
      {"fast", [](ArcInputs& in) { in.speed_mm_s = 13.1; }, Fault::kSpeedOutOfWindow},
      {"speed nan", [](ArcInputs& in) { in.speed_mm_s = kNan; }, Fault::kSpeedOutOfWindow},
      {"box x", [](ArcInputs& in) { in.p_base.x() = 3000.1; }, Fault::kOutsideWorkspace},
      {"box z", [](ArcInputs& in) { in.p_base.z() = -3000.1; }, Fault::kOutsideWorkspace},
      {"box nan", [](ArcInputs& in) { in.p_base.y() = kNan; }, Fault::kOutsideWorkspace},
      {"corridor", [](ArcInputs& in) { in.corridor_mm = 2.01; }, Fault::kOutsideCorridor},
      {"corridor nan", [](ArcInputs& in) { in.corridor_mm = kNan; }, Fault::kOutsideCorridor},
      {"overrun", [](ArcInputs& in) { in.overrun = true; }, Fault::kOverrun},
      {"stands", [](ArcInputs& in) { in.standing_ns = 1'500'000'001; }, Fault::kStandstill}};
  return all;
}

TEST(ArcGate, lets_the_arc_burn_while_every_condition_holds) {
  const ArcGate gate = ArcGate::make({}).value();

  EXPECT_EQ(gate.check(all_well()), Fault::kNone);
}

TEST(ArcGate, trips_on_each_condition_alone_with_its_own_name) {
  const ArcGate gate = ArcGate::make({}).value();
  for (const Loss& loss : losses()) {
    ArcInputs in = all_well();
    loss.lose(in);

    const Fault fault = gate.check(in);

    EXPECT_EQ(fault, loss.fault) << loss.name;
  }
}

TEST(ArcGate, two_losses_never_make_a_permit) {
  const ArcGate gate = ArcGate::make({}).value();
  for (const Loss& a : losses()) {
    for (const Loss& b : losses()) {
      ArcInputs in = all_well();
      a.lose(in);
      b.lose(in);

      EXPECT_EQ(gate.check(in), std::min(a.fault, b.fault)) << a.name << " and " << b.name;
    }
  }
}

TEST(ArcGate, the_limits_themselves_still_hold) {
  const ArcGate gate = ArcGate::make({}).value();
  ArcInputs in = all_well();
  in.data_age_ns = 20'000'000;
  in.pose_age_ns = 60'000'000;
  in.bus = BusState::kErrorWarning;
  in.confidence = Confidence::kLow;
  in.stream_age_ns = 100'000'000;
  in.tracking_mm = 5.0;
  in.corridor_mm = 2.0;
  in.speed_mm_s = 13.0;
  in.p_base.setConstant(3000.0);
  in.standing_ns = 1'500'000'000;

  EXPECT_EQ(gate.check(in), Fault::kNone);
}

TEST(ArcGate, a_fast_weld_has_a_wider_window) {
  const ArcGate gate = ArcGate::make({}).value();
  ArcInputs in = all_well();
  in.planned_low_mm_s = 100.0;
  in.planned_high_mm_s = 100.0;
  in.speed_mm_s = 129.0;

  EXPECT_EQ(gate.check(in), Fault::kNone);
}

TEST(ArcGate, limits_that_are_none_are_refused) {
  const auto refused = [](auto set) {
    ArcGate::Config config;
    set(config);
    return !ArcGate::make(config).ok();
  };

  EXPECT_TRUE(refused([](auto& c) { c.max_tracking_mm = 0.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.speed_tolerance_mm_s = -1.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.speed_tolerance_share = kNan; }));
  EXPECT_TRUE(refused([](auto& c) { c.max_corridor_mm = kNan; }));
  EXPECT_TRUE(refused([](auto& c) { c.min_confidence = static_cast<Confidence>(4); }));
  EXPECT_TRUE(refused([](auto& c) { c.max_data_age_ns = 0; }));
  EXPECT_TRUE(refused([](auto& c) { c.max_pose_age_ns = 0; }));
  EXPECT_TRUE(refused([](auto& c) { c.max_stream_age_ns = -1; }));
  EXPECT_TRUE(refused([](auto& c) { c.max_standing_ns = 0; }));
  EXPECT_TRUE(refused([](auto& c) { c.workspace.low_mm.x() = 4000.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.workspace.high_mm.z() = kNan; }));
}

TEST(Faults, each_has_a_name_of_its_own) {
  std::vector<std::string> names;
  for (std::uint8_t i = 0; i < dseam::rt::kNumFaults; ++i) {
    names.emplace_back(dseam::rt::name(static_cast<Fault>(i)));
  }
  std::sort(names.begin(), names.end());

  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  EXPECT_STREQ(dseam::rt::name(static_cast<Fault>(200)), "Unknown");
}

TEST(FaultLatch, keeps_the_first_and_counts_all) {
  dseam::rt::FaultLatch latch;

  EXPECT_FALSE(latch.set(Fault::kNone));
  EXPECT_TRUE(latch.set(Fault::kOverrun));
  EXPECT_FALSE(latch.set(Fault::kBusOff));
  EXPECT_EQ(latch.first(), Fault::kOverrun);
  EXPECT_EQ(latch.count(), 2U);
  latch.clear();
  EXPECT_FALSE(latch.any());
  EXPECT_EQ(latch.count(), 2U);
}

}  // namespace
