// SPDX-License-Identifier: Apache-2.0
// Eq. DB-7 on sessions whose stalls are known, message by message as the bus brings them.
#include "apps/dashboard/feed/cost_so_far.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "tests/support/stalled_session.hpp"

namespace stillhand::dashboard::cost_so_far_test {

using tests::Faults;
using tests::StalledSession;

stillhand_msgs::TrialControl control_of(const Trial& trial) {
  stillhand_msgs::TrialControl control;
  control.trial(static_cast<std::int32_t>(trial.number));
  control.phase(stillhand_msgs::PHASE_TRACKING);
  control.start_tick(trial.start_tick);
  control.duration_ticks(trial.duration_ticks);
  control.ramp_ticks(trial.ramp_ticks);
  return control;
}

stillhand_msgs::TrialAssignment assignment_of(const Trial& trial, bool cancels) {
  stillhand_msgs::TrialAssignment assignment;
  assignment.trial(static_cast<std::int32_t>(trial.number));
  assignment.cancellation(cancels);
  return assignment;
}

struct Heard {
  explicit Heard(const Faults& faults, std::uint64_t seed = 0)
      : session(tests::stalled_session(seeded(faults, seed))), sut(tests::configs_of(faults)) {
    sut.take(session.recording.control_models.front());
    sut.take(control_of(session.trial));
  }
  // --gtest_random_seed=N: other noise, another motion, stalls at other moments.
  static Faults seeded(Faults faults, std::uint64_t seed) {
    faults.seed = seed + 1 + static_cast<std::uint64_t>(GTEST_FLAG_GET(random_seed));
    return faults;
  }
  void hear(Tick from, Tick until) {
    const auto& recording = session.recording;
    const auto at = [](const auto& stream, Tick tick) {
      return std::ranges::lower_bound(stream, tick, {}, [](const auto& m) { return m.tick(); });
    };
    for (Tick tick = from; tick < until; ++tick) {
      const auto raw = at(recording.raw_samples, tick);
      if (raw == recording.raw_samples.end()) return;
      sut.take(*raw);
      const auto sensed = at(recording.sensed, tick);
      if (sensed != recording.sensed.end() && sensed->tick() == tick) {
        sut.take(*sensed, tick * 1'000'000 + 100'000);
      }
      const auto command = at(recording.motor_commands, tick);
      if (command != recording.motor_commands.end() && command->tick() == tick) {
        sut.take(*command, tick * 1'000'000 + 200'000);
      }
      sut.take(*at(recording.rig_truths, tick));
    }
  }
  void hear_all() { hear(0, tests::kStalledStart + tests::kStalledLength); }
  double force_n(double session::ForceSums::* of) const {
    return sut.cost()->sums.force_n(sut.cost()->sums.*of);
  }

  StalledSession session;
  CostSoFar sut;
};

// The part of the trial that has been judged, from the session without the stalls.
double known_n(const Heard& stalled, const StalledSession& whole) {
  const auto ticks = static_cast<std::size_t>(stalled.sut.cost()->sums.ticks);
  StalledSession part = stalled.session;
  part.motor_n.resize(ticks);
  std::vector<double> late_n = tests::difference(part.motor_n, whole.motor_n);
  return tests::share_n(part, late_n);
}

TEST(CostSoFarTest, IsWhatKnownStallsDidAndIsOfTheProcessThatStood) {
  for (const bool of_sensing : {true, false}) {
    for (const Tick stall : {30, 73, 200}) {
      Heard heard({.stall_ticks = stall, .of_sensing = of_sensing});
      heard.sut.take(assignment_of(heard.session.trial, true));
      heard.hear_all();
      ASSERT_TRUE(heard.sut.cost());
      const double want_n = known_n(heard, Heard({}).session);
      const double late_n = heard.force_n(&session::ForceSums::lateness);
      std::printf("%s stands %3d ms a second: %.4f N known, %.4f N so far\n",
                  of_sensing ? "sensing" : "cancellation", static_cast<int>(stall), want_n, late_n);
      EXPECT_GT(want_n, 0.0);
      EXPECT_NEAR(late_n, want_n, 0.05 * want_n);
      const Cost& cost = *heard.sut.cost();
      const Late who = of_sensing ? Late::kSensing : Late::kCancellation;
      EXPECT_NEAR(cost.late[static_cast<std::size_t>(who)], cost.sums.lateness,
                  0.05 * cost.sums.lateness);
    }
  }
}

TEST(CostSoFarTest, ThePartsAddUpAtAnyMomentAndACopyGoesOnAlone) {
  Heard heard({.stall_ticks = 73, .max_force_n = 3.0});
  heard.sut.take(assignment_of(heard.session.trial, true));
  heard.hear(0, 15'000);
  const CostSoFar copy = heard.sut;
  heard.hear(15'000, 20'000);
  EXPECT_EQ(copy.cost()->sums.ticks, 15'000.0 - tests::kStalledStart - CostSoFar::kMargin);
  EXPECT_EQ(heard.sut.cost()->sums.ticks, 20'000.0 - tests::kStalledStart - CostSoFar::kMargin);
  const session::ForceSums& sums = heard.sut.cost()->sums;
  EXPECT_NEAR(sums.lateness + sums.limits + sums.sensor + sums.rest, sums.left, 1e-6 * sums.left);
  EXPECT_GT(sums.limits, 0.0);
}

TEST(CostSoFarTest, AWholeSessionCostsNothing) {
  Heard heard({});
  heard.sut.take(assignment_of(heard.session.trial, true));
  heard.hear_all();
  EXPECT_NEAR(heard.force_n(&session::ForceSums::lateness), 0.0, 1e-9);
  EXPECT_EQ(heard.sut.why_none(), "");
}

TEST(CostSoFarTest, SaysWhyThereIsNone) {
  Heard heard({});
  heard.hear(0, 10'000);
  EXPECT_EQ(heard.sut.why_none(), "the motor does not cancel in this trial");
  heard.sut.take(assignment_of(heard.session.trial, true));
  heard.hear(10'000, 11'000);
  EXPECT_FALSE(heard.sut.cost());
  Heard late({});
  late.sut.take(assignment_of(late.session.trial, true));
  late.hear(5'000, 8'000);  // in the first ramp
  EXPECT_EQ(late.sut.why_none(), "no model, or the trial began before this page heard it");
}

TEST(CostSoFarTest, ATrialThatIsStoppedPaysNoMore) {
  Heard heard({});
  heard.sut.take(assignment_of(heard.session.trial, true));
  heard.hear(0, 10'000);
  heard.sut.take(stillhand_msgs::TrialControl{});
  heard.hear(10'000, 12'000);
  EXPECT_EQ(heard.sut.cost()->sums.ticks, 10'000.0 - 1 - tests::kStalledStart);
}

}  // namespace stillhand::dashboard::cost_so_far_test
