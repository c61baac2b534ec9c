// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/session_machine.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace {

using dseam::rt::kNumSessionEvents;
using dseam::rt::kNumSessionStates;
using dseam::rt::session_step;
using A = dseam::rt::SessionAction;
using E = dseam::rt::SessionEvent;
using S = dseam::rt::SessionState;

template <typename F>
void for_each_pair(F f) {
  for (std::uint8_t s = 0; s < kNumSessionStates; ++s) {
    for (std::uint8_t e = 0; e < kNumSessionEvents; ++e) {
      f(static_cast<S>(s), static_cast<E>(e));
    }
  }
}

bool may_move(S s) { return s == S::kRunning; }
bool heartbeat(S s) { return s >= S::kArmed && s <= S::kStopping; }

TEST(SessionMachine, the_way_of_a_weld_leads_from_idle_to_idle) {
  const E way[] = {E::kScan, E::kPlan,  E::kArm,      E::kLoad,   E::kStart,
                   E::kHold, E::kStart, E::kFinished, E::kStopped};
  S state = S::kIdle;
  for (const E event : way) {
    const auto step = session_step(state, event);
    EXPECT_NE(step.action, A::kRefuse) << name(state) << " " << name(event);
    state = step.next;
  }

  EXPECT_EQ(state, S::kIdle);
}

TEST(SessionMachine, every_fault_trips_unless_one_is_latched_already) {
  for (std::uint8_t s = 0; s < kNumSessionStates; ++s) {
    const auto state = static_cast<S>(s);
    const auto step = session_step(state, E::kFault);
    if (state == S::kSafe || state == S::kFault) {
      EXPECT_EQ(step.next, state);
    } else {
      EXPECT_EQ(step, (dseam::rt::SessionStep{S::kFault, A::kTrip})) << name(state);
    }
  }
}

TEST(SessionMachine, nothing_but_an_edge_of_arming_starts_a_heartbeat) {
  for_each_pair([](S state, E event) {
    const auto step = session_step(state, event);
    if (!heartbeat(state) && heartbeat(step.next)) {
      EXPECT_EQ(state, S::kPlanned);
      EXPECT_EQ(event, E::kArm);
    }
  });
}

TEST(SessionMachine, motion_starts_by_start_alone_and_every_way_out_of_it_acts) {
  for_each_pair([](S state, E event) {
    const auto step = session_step(state, event);
    if (!may_move(state) && may_move(step.next)) {
      EXPECT_EQ(event, E::kStart);
      EXPECT_EQ(step.action, A::kBeginRunning);
    }
    if (may_move(state) && !may_move(step.next)) {
      EXPECT_TRUE(step.action == A::kBeginHold || step.action == A::kBeginStop ||
                  step.action == A::kTrip);
    }
  });
}

TEST(SessionMachine, stop_and_disarm_are_never_refused) {
  for_each_pair([](S state, E event) {
    if (event == E::kStop || event == E::kDisarm) {
      EXPECT_NE(session_step(state, event).action, A::kRefuse) << name(state);
    }
  });
}

TEST(SessionMachine, a_latched_fault_leaves_by_rest_and_then_reset_alone_and_forgets_the_plan) {
  for_each_pair([](S state, E event) {
    const auto step = session_step(state, event);
    if (state == S::kFault && step.next != S::kFault) {
      EXPECT_EQ(event, E::kStopped);
      EXPECT_EQ(step.next, S::kSafe);
    }
    if (state == S::kSafe && step.next != S::kSafe) {
      EXPECT_EQ(event, E::kReset);
      EXPECT_EQ(step, (dseam::rt::SessionStep{S::kIdle, A::kForget}));
    }
  });
}

TEST(SessionMachine, a_refused_event_changes_nothing) {
  for_each_pair([](S state, E event) {
    const auto step = session_step(state, event);
    if (step.action == A::kRefuse) {
      EXPECT_EQ(step.next, state);
    }
  });
}

TEST(SessionMachine, every_state_and_event_has_a_name) {
  for_each_pair([](S state, E event) {
    EXPECT_STRNE(name(state), "Unknown");
    EXPECT_STRNE(name(event), "Unknown");
  });
}

TEST(SessionMachine, values_outside_the_table_trip) {
  const dseam::rt::SessionStep tripped{S::kFault, A::kTrip};

  EXPECT_EQ(session_step(static_cast<S>(kNumSessionStates), E::kScan), tripped);
  EXPECT_EQ(session_step(S::kIdle, static_cast<E>(kNumSessionEvents)), tripped);
  EXPECT_STREQ(name(static_cast<S>(99)), "Unknown");
  EXPECT_STREQ(name(static_cast<E>(99)), "Unknown");
}

}  // namespace
