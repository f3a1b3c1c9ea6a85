// SPDX-License-Identifier: Apache-2.0
// The mitigations of a session's trials, one after the other, as the process runs them: METHOD
// CC-18.  The making thread is real.  About a second.
#include "services/processes/cancellation/trial_parts.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <mutex>
#include <string>
#include <vector>

#include "tests/support/wait.hpp"

namespace stillhand::cancellation::trial_parts_test {
namespace {

using cancellation::Part;
using cancellation::PartKind;

constexpr double kTurn = 6.283185307179586;
// Never near the middle, where a spring has no force.
double theta_rad(Tick tick) {
  return 0.05 * std::sin(kTurn * 0.4e-3 * static_cast<double>(tick)) + 0.08;
}

const std::vector<Part> kSpring{{PartKind::kImpedance, {400.0, 1.0, 0.0}}};
const std::vector<Part> kSignal{{PartKind::kSignal}};
const signal::DifferenceModel kPosition{1000.0, {-0.003}, {1.0}};

// The process without the bus: assignment and trial, then sample by sample.
class TrialPartsTest : public testing::Test {
 protected:
  /// A trial whose first measured tick is `lead` ticks ahead, of 1000 ticks and ramps of 300.
  void announce(std::int64_t number, const std::vector<Part>& parts, bool cancellation = false,
                Tick lead = 800) {
    arming_.assign({number, cancellation, !parts.empty(), needs_force(parts)});
    sut_.want({parts, number, arming_.newest()});
    trial_ = {number, TrialPhase::kTracking, tick_ + lead, 1000, 300};
    arming_.announce(trial_);
  }

  struct Answer {
    CountermeasureOutput output;
    bool enabled;
    std::int64_t trial;
  };
  /// One sample, with 1 m/s^2.
  Answer step() {
    ++tick_;
    CountermeasureInput input{};
    input.tick = tick_;
    input.sensed[static_cast<std::size_t>(Channel::kAccelY)] = 1.0;
    input.sensed[static_cast<std::size_t>(Channel::kTheta)] = theta_rad(tick_);
    input.permitted = true;
    sut_.follow(tick_, arming_, core_);
    input.enabled = sut_.enables(tick_, arming_, core_);
    const Answer answer{core_.step(input), input.enabled, sut_.trial_of(core_)};
    // At every tick of every test: the envelope, and a command without a jump.
    const signal::ForceLimits limits;
    const double force_n = answer.output.force_n;
    EXPECT_LE(std::abs(force_n), limits.max_force_n);
    EXPECT_LE(std::abs(force_n - force_n_), limits.max_slew_n_s * 1e-3 + 1e-12);
    EXPECT_LE(std::abs(answer.output.taken_off_rad - off_rad_), 7.0 / 250.0 * 0.03 + 1e-12);
    force_n_ = force_n;
    off_rad_ = answer.output.taken_off_rad;
    return answer;
  }
  Answer step_to(Tick tick) {
    Answer answer{};
    while (tick_ < tick) answer = step();
    return answer;
  }
  /// The clock stands until the making thread has made what was wanted.
  bool taken() {
    return support::eventually([this] {
      sut_.follow(tick_, arming_, core_);
      return sut_.prepared().assignment == arming_.newest();
    });
  }
  [[nodiscard]] Readiness readiness() const {
    return arming_.readiness(core_.has_model(), std::nullopt, sut_.prepared());
  }
  std::string refusals() {
    const std::lock_guard lock(mutex_);
    return refusals_;
  }

  std::mutex mutex_;
  std::string refusals_;
  TrialArming arming_;
  Trial trial_;
  Tick tick_ = 0;
  double force_n_ = 0.0;
  double off_rad_ = 0.0;
  std::atomic<bool> hold_{false};  ///< the making thread stands still at its next refusal
  Countermeasure core_{Config{}};
  TrialParts sut_{{}, {.force = true}, [this](const char* why) {
                    {
                      const std::lock_guard lock(mutex_);
                      refusals_ += why;
                    }
                    support::eventually([this] { return !hold_.load(); });
                  }};
};

// Its ramp ends it: 40 ticks, by the envelope that step() checks at each of them.
TEST_F(TrialPartsTest, TheForceIsZeroWithinTheRampOnceTheTrialEnds) {
  announce(1, kSpring);
  ASSERT_TRUE(taken());
  EXPECT_EQ(readiness(), Readiness::kArmed);
  const Tick end = trial_.start_tick + trial_.duration_ticks + trial_.ramp_ticks;
  ASSERT_GT(std::abs(step_to(end - 1).output.force_n), 0.5);
  const auto last = step_to(end + signal::ForceLimits{}.ramp_ticks);
  EXPECT_FALSE(last.enabled);
  EXPECT_EQ(last.output.force_n, 0.0);
  EXPECT_EQ(step_to(end + 500).output.force_n, 0.0);
}

// The same where somebody stops it in the middle: the trial is gone at once.
TEST_F(TrialPartsTest, TheForceIsZeroWithinTheRampOnceTheTrialIsStopped) {
  announce(1, kSpring);
  ASSERT_TRUE(taken());
  ASSERT_GT(std::abs(step_to(trial_.start_tick + 500).output.force_n), 0.5);
  arming_.announce({});
  const auto last = step_to(tick_ + signal::ForceLimits{}.ramp_ticks);
  EXPECT_EQ(last.output.force_n, 0.0);
}

TEST_F(TrialPartsTest, ASecondMitigationFollowsTheFirst) {
  announce(1, kSpring);
  ASSERT_TRUE(taken());
  ASSERT_GT(std::abs(step_to(trial_.start_tick + 500).output.force_n), 0.5);
  step_to(trial_.start_tick + 1400);
  sut_.offer_position(kPosition);
  announce(2, kSignal);
  ASSERT_TRUE(taken());
  EXPECT_EQ(readiness(), Readiness::kArmed);
  const auto second = step_to(trial_.start_tick);
  EXPECT_EQ(second.trial, 2);
  EXPECT_EQ(second.output.force_n, 0.0);
  EXPECT_NEAR(second.output.taken_off_rad, -0.03, 1e-12);  // G a/lever
  EXPECT_EQ(step_to(trial_.start_tick + 1340).output.taken_off_rad, 0.0);
}

// Another assignment while the first acts: it fades, then the second is taken, too late to act.
TEST_F(TrialPartsTest, AnAssignmentWithinATrialEndsItsMitigation) {
  sut_.offer_position(kPosition);
  announce(1, kSignal);
  ASSERT_TRUE(taken());
  const auto first = step_to(trial_.start_tick + 100);
  ASSERT_NEAR(first.output.taken_off_rad, -0.03, 1e-12);
  const Trial same = trial_;
  announce(1, kSpring);
  arming_.announce(same);
  step_to(tick_ + signal::ForceLimits{}.ramp_ticks);
  EXPECT_EQ(off_rad_, 0.0);
  ASSERT_TRUE(taken());
  EXPECT_EQ(readiness(), Readiness::kMitigationTooLate);
  for (int n = 0; n < 600; ++n) {
    step();
    ASSERT_EQ(force_n_, 0.0);
  }
}

TEST_F(TrialPartsTest, ConditionCAfterAMitigationIsTheCancellers) {
  announce(1, kSpring);
  ASSERT_TRUE(taken());
  step_to(trial_.start_tick + 1400);
  announce(2, {}, true);
  EXPECT_EQ(readiness(), Readiness::kNoModel);
  core_.load_model(control_model({1000.0, {-3.2}, {1.0}}));
  EXPECT_EQ(readiness(), Readiness::kArmed);
  EXPECT_EQ(step().trial, 0);
  EXPECT_NEAR(step_to(trial_.start_tick + 10).output.force_n, 3.2, 1e-12);
}

// A number that comes again, with parts that are refused and then with others.
TEST_F(TrialPartsTest, AReusedTrialNumberRunsNothingOfBefore) {
  announce(1, kSpring);
  ASSERT_TRUE(taken());
  step_to(trial_.start_tick + 1400);
  announce(1, kSignal);  // whose model never came
  ASSERT_TRUE(support::eventually([this] { return !refusals().empty(); }));
  EXPECT_EQ(readiness(), Readiness::kNoMitigation);
  while (tick_ < trial_.start_tick + 500) ASSERT_EQ(step().trial, 0);
  announce(1, {{PartKind::kImpedance, {800.0, 2.0, 0.0}}});
  ASSERT_TRUE(taken());
  EXPECT_EQ(readiness(), Readiness::kArmed);
  // -K x of the new spring in full effect.
  step_to(trial_.start_tick + 200);
  EXPECT_NEAR(force_n_, -800.0 * 0.1 * theta_rad(tick_), 1e-9);
}

// An assignment can come before the model of the trial before it: made once that is there.
TEST_F(TrialPartsTest, AModelThatComesBehindTheAssignmentMakesIt) {
  announce(1, kSignal);
  ASSERT_TRUE(support::eventually([this] { return !refusals().empty(); }));
  EXPECT_EQ(readiness(), Readiness::kNoMitigation);
  sut_.offer_position(kPosition);
  ASSERT_TRUE(taken());
  EXPECT_EQ(readiness(), Readiness::kArmed);
  // Once the trial has begun, one of another model is not taken.
  EXPECT_NEAR(step_to(trial_.start_tick).output.taken_off_rad, -0.03, 1e-12);
  sut_.offer_position({1000.0, {0.0}, {1.0}});
  for (int n = 0; n < 1200; ++n) {
    const auto answer = step();
    ASSERT_NEAR(answer.output.taken_off_rad, -0.03, 1e-12);
  }
}

// It may be preempted for as long as the machine likes: the receiving thread goes on, and what
// finds no room is refused.
TEST_F(TrialPartsTest, AMakingThreadThatStandsStillHoldsNobodyUp) {
  announce(1, kSpring);
  ASSERT_TRUE(taken());
  ASSERT_GT(std::abs(step_to(trial_.start_tick + 500).output.force_n), 0.5);
  hold_ = true;
  announce(2, kSignal);
  EXPECT_TRUE(support::eventually([this] { return !refusals().empty(); }));
  int accepted = 0;
  while (accepted < 1000 && sut_.offer_position(kPosition)) ++accepted;
  EXPECT_EQ(accepted, 16);
  step_to(tick_ + signal::ForceLimits{}.ramp_ticks);
  EXPECT_EQ(force_n_, 0.0);
  EXPECT_EQ(readiness(), Readiness::kNoMitigation);
  hold_ = false;
  ASSERT_TRUE(taken());
  EXPECT_EQ(readiness(), Readiness::kArmed);
}

// C' behind C: the same model, whose gain and phase begin at 1 and 0.
TEST_F(TrialPartsTest, AHandIsFollowedInItsTrialAlone) {
  core_.load_model(control_model({1000.0, {-3.2}, {1.0}}));
  announce(1, {{PartKind::kForce, {1.394, 11.18, 1136.0, 0.10}}});
  ASSERT_TRUE(taken());
  EXPECT_EQ(readiness(), Readiness::kArmed);
  EXPECT_NE(step_to(trial_.start_tick + 500).output.weights[0], 1.0);
  step_to(trial_.start_tick + 1400);
  announce(2, {}, true);
  const Answer plain = step_to(trial_.start_tick);
  EXPECT_EQ(plain.output.weights[0], 1.0);
  EXPECT_NEAR(plain.output.force_n, 3.2, 1e-12);  // SG-6 rounds
}

// 919 ticks to settle, and a fade of 250 (Eq. CC-4): with a lead of 1168 it comes a tick too late.
TEST_F(TrialPartsTest, AMitigationHasToSettleAndFadeInBeforeTheTrial) {
  sut_.offer_position({1000.0, {-0.003 * 0.005, 0.0}, {1.0, -0.995}});
  announce(1, kSignal, false, 1169);
  ASSERT_TRUE(taken());
  EXPECT_EQ(readiness(), Readiness::kArmed);
  announce(2, kSignal, false, 1168);
  ASSERT_TRUE(taken());
  EXPECT_EQ(readiness(), Readiness::kMitigationTooLate);
  step_to(trial_.start_tick + 500);
  EXPECT_EQ(off_rad_, 0.0);
}

// The same for the first model of f^: 919 and 250 ticks.
TEST_F(TrialPartsTest, TheFirstModelOfTheForceHasToSettleBeforeATrialThatNeedsIt) {
  core_.load_model(control_model({1000.0, {-3.2 * 0.005, 0.0}, {1.0, -0.995}}));
  EXPECT_EQ(core_.unsettled_ticks(), 919 + 250);
  announce(1, {{PartKind::kForce, {}}}, false, 1169);
  ASSERT_TRUE(taken());
  EXPECT_EQ(readiness(), Readiness::kArmed);
  announce(2, {{PartKind::kForce, {}}}, false, 1168);
  ASSERT_TRUE(taken());
  EXPECT_EQ(readiness(), Readiness::kMitigationTooLate);
  step_to(trial_.start_tick + 500);
  EXPECT_EQ(force_n_, 0.0);
}

}  // namespace
}  // namespace stillhand::cancellation::trial_parts_test
