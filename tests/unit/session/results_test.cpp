// SPDX-License-Identifier: Apache-2.0
// Results of a recording whose samples the test has written.
#include "apps/libraries/session/results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/support/rms_share.hpp"
#include "tests/unit/session/recorded_session.hpp"

namespace stillhand::session::results_test {
namespace {

using made::acceleration_m_s2;
using made::kTrial_ticks;
using made::outcome_of;
using made::Tape;

constexpr Tick kStart = 1000;
constexpr Tick kEnd = kStart + kTrial_ticks;

TEST(EvaluateTest, ACursorThatIsOffByTheSameEverywhereHasThatError) {
  for (const double off_m : {0.0, 0.010, -0.014, 0.016}) {
    Tape tape;
    tape.whole_tracking(kStart, kEnd, off_m);
    const auto sut = evaluate(tape.close(), {outcome_of(2, Condition::kA, kStart)});
    ASSERT_EQ(sut.trials.size(), 1u);
    EXPECT_EQ(sut.trials[0].number, 2);
    EXPECT_EQ(sut.trials[0].label, Condition::kA);
    // Target and cursor are below 0.05 m: their difference is exact to 1e-17 m.
    EXPECT_NEAR(sut.trials[0].metrics.rms_error_mm, 1000.0 * std::abs(off_m), 1e-11);
    EXPECT_EQ(sut.trials[0].metrics.dwell_ratio, std::abs(off_m) < 0.015 ? 1.0 : 0.0);
  }
}

// Whatever was reported while it ran.  A second in one piece is too much, wherever it is.
TEST(EvaluateTest, ATrialThatTheRecordingLacksDoesNotCount) {
  for (const Tick lost : {1000, 1001}) {
    for (const Tick from : {kStart, kStart + 2000, kEnd - lost}) {
      Tape tape;
      for (Tick tick = kStart; tick < kEnd; ++tick) {
        if (tick < from || tick >= from + lost) tape.tracking(tick, 0.0, 0.0);
      }
      const auto sut = evaluate(tape.close(), {outcome_of(1, Condition::kA, kStart)});
      EXPECT_EQ(sut.trials.size(), lost == 1000 ? 1u : 0u) << from;
      EXPECT_EQ(sut.unrecorded.size(), lost == 1000 ? 0u : 1u) << from;
    }
  }
  Tape nothing;
  nothing.tracking(kEnd + 1'000'000, 0.0, 0.0);
  const auto sut = evaluate(nothing.close(), {outcome_of(1, Condition::kA, kStart)});
  EXPECT_EQ(sut.unrecorded.at(1), "the recording lacks 5000 of its 5000 ticks in one piece");
}

// A sample before or after the trial would add an error of a metre.
TEST(EvaluateTest, OnlyTheMeasuredTicksCount) {
  Tape tape;
  for (Tick tick = kStart - 100; tick < kStart; ++tick) tape.tracking(tick, 1.0, 0.0);
  tape.whole_tracking(kStart, kEnd, 0.010);
  for (Tick tick = kEnd; tick < kEnd + 100; ++tick) tape.tracking(tick, 1.0, 0.0);
  const auto sut = evaluate(tape.close(), {outcome_of(1, Condition::kA, kStart)});
  EXPECT_NEAR(sut.trials.at(0).metrics.rms_error_mm, 10.0, 1e-11);
}

// Two errors, the first over exactly the third that does not count.
TEST(EvaluateTest, TheSettledErrorLeavesOutTheFirstThird) {
  Tape tape;
  constexpr Tick kThird = kTrial_ticks / 3;
  for (Tick tick = kStart; tick < kEnd; ++tick) {
    tape.tracking(tick, tick < kStart + kThird ? 0.020 : 0.006, 0.0);
  }
  const auto sut = evaluate(tape.close(), {outcome_of(1, Condition::kA, kStart)});
  EXPECT_NEAR(sut.trials.at(0).settled_rms_error_mm, 6.0, 1e-11);
  EXPECT_GT(sut.trials.at(0).metrics.rms_error_mm, 12.0);
}

TEST(EvaluateTest, AModelOfAFreeStickIsNotTheSessionsModel) {
  Tape tape;
  tape.whole_tracking(kStart, kEnd, 0.010);
  for (const bool to_position : {false, true}) {
    stillhand_msgs::FeedthroughModel model;
    model.model(to_position ? 1 : 0);
    model.to_position(to_position);
    tape.file.add(topics::kFeedthroughModel, model);
  }
  const auto sut = evaluate(tape.close(), {outcome_of(1, Condition::kA, kStart)});
  ASSERT_TRUE(sut.model);
  EXPECT_EQ(sut.model->model(), 0);
}

// Which model a mitigation ran: that of the force as the commands name it, that of the position as
// the newest that came before the trial.
TEST(EvaluateTest, TheModelsOfAMitigationAreThoseOfItsTrial) {
  using cancellation::PartKind;
  Tape tape;
  tape.whole_tracking(kStart, kEnd, 0.0);
  // Number, trial, to position, usable.
  using Row = std::tuple<int, int, bool, bool>;
  for (const auto& [number, trial, to_position, usable] :
       {Row{0, 0, false, true}, Row{1, 1, true, true}, Row{2, 2, true, true},
        Row{3, 3, true, false}, Row{4, 5, true, true}}) {
    stillhand_msgs::FeedthroughModel model;
    model.model(number);
    model.trial(trial);
    model.to_position(to_position);
    model.usable(usable);
    model.fit_rate_hz(50.0);
    model.control_rate_hz(1000.0);
    for (auto* taps : {&model.fit_numerator(), &model.fit_denominator(), &model.control_numerator(),
                       &model.control_denominator()}) {
      *taps = {1.0};
    }
    tape.file.add(topics::kFeedthroughModel, model);
  }
  for (const auto& [tick, number] : {std::pair{kStart - 1, 0}, {kStart, 1000}, {kEnd, 1001}}) {
    stillhand_msgs::MotorCommand command;
    command.tick(tick);
    command.model(number);
    tape.file.add(topics::kMotorCommand, command);
  }
  const std::string path = tape.close();
  const auto models = [&](const std::vector<cancellation::Part>& parts, Condition label) {
    TrialOutcome outcome = outcome_of(4, label, kStart);
    outcome.planned.parts = parts;
    return evaluate(path, {outcome}).trials.at(0).models;
  };
  EXPECT_EQ(models({{PartKind::kSignal}}, Condition::kSignal).position, 2);
  EXPECT_EQ(models({{PartKind::kSignal}}, Condition::kSignal).force, std::nullopt);
  EXPECT_EQ(models({{PartKind::kPredictedSignal}}, Condition::kModelFilter).force, 1000);
  EXPECT_EQ(models({{PartKind::kPredictedSignal}}, Condition::kModelFilter).position, std::nullopt);
  EXPECT_EQ(models({}, Condition::kC).force, 1000);
  EXPECT_EQ(models({{PartKind::kImpedance}}, Condition::kDamping).force, std::nullopt);
}

// The sample before is held: 500 ticks of the error 0, then 20 lost ones that hold it, then 12 mm.
TEST(EvaluateTest, ALostSampleHoldsTheOneBefore) {
  Tape tape;
  for (Tick tick = kStart; tick < kEnd; ++tick) {
    const Tick n = tick - kStart;
    if (n >= 500 && n < 520) continue;
    tape.tracking(tick, n < 500 ? 0.0 : 0.012, 0.0);
  }
  const auto sut = evaluate(tape.close(), {outcome_of(1, Condition::kA, kStart)});
  EXPECT_NEAR(sut.trials.at(0).metrics.rms_error_mm, 12.0 * std::sqrt(4480.0 / 5000.0), 1e-11);
  EXPECT_EQ(sut.lost_ticks.at(std::string(topics::kTrackingSample.name)), 20);
}

TEST(EvaluateTest, ASampleThatComesTwiceCountsOnce) {
  Tape tape;
  for (Tick tick = kStart; tick < kEnd; ++tick) {
    tape.tracking(tick, 0.010, 0.0);
    if (tick % 3 == 0) tape.tracking(tick, 0.010, 0.0);
  }
  const auto sut = evaluate(tape.close(), {outcome_of(1, Condition::kA, kStart)});
  EXPECT_NEAR(sut.trials.at(0).metrics.rms_error_mm, 10.0, 1e-11);
}

TEST(EvaluateTest, OnlyCompletedTrackingTrialsAreEvaluated) {
  Tape tape;
  tape.whole_tracking(kStart, kStart + 2 * kTrial_ticks, 0.0);
  std::vector<TrialOutcome> outcomes{outcome_of(0, Condition::kIdentification, kStart),
                                     outcome_of(1, Condition::kA, kStart),
                                     outcome_of(2, Condition::kA, kEnd)};
  outcomes[0].planned.trial.phase = TrialPhase::kPegged;
  outcomes[1].completed = false;
  outcomes[1].aborted = "stopped";
  const std::string path = tape.close();
  const auto sut = evaluate(path, outcomes);
  ASSERT_EQ(sut.trials.size(), 1u);
  EXPECT_EQ(sut.trials[0].number, 2);
  EXPECT_TRUE(evaluate(path, {}).trials.empty());
}

// A whole trial with f' of the body, and a motor that takes off `share` of it `late` ticks late.
struct ForcedTape : Tape {
  ForcedTape(double share, Tick late) {
    whole_tracking(kStart, kEnd, 0.0);
    const auto feedthrough_n = [](Tick tick) { return -3.2 * acceleration_m_s2(tick); };
    for (Tick tick = kStart; tick < kEnd; ++tick) {
      truth(tick, feedthrough_n(tick), -share * feedthrough_n(tick - late));
    }
  }
};

// The force of a damper answers the stick: how late it opposes f' means nothing.
TEST(EvaluateTest, OnlyACounterforceHasADelay) {
  using cancellation::PartKind;
  ForcedTape tape(0.8, 3);
  const std::string path = tape.close();
  const auto delays = [&](const std::vector<cancellation::Part>& parts) {
    TrialOutcome outcome = outcome_of(1, Condition::kDampingForce, kStart);
    outcome.planned.parts = parts;
    return std::isfinite(evaluate(path, {outcome}).trials.at(0).counterforce_delay_s);
  };
  EXPECT_TRUE(delays({{PartKind::kForce}}));
  EXPECT_TRUE(delays({{PartKind::kLmsForce}}));
  EXPECT_FALSE(delays({{PartKind::kImpedance}}));
  EXPECT_FALSE(delays({{PartKind::kForce}, {PartKind::kImpedance}}));
  EXPECT_FALSE(delays({{PartKind::kSignal}}));
}

// 20 s.  Five seconds before the loss are shown, and twelve in all, as far as the trial has them.
TEST(EvaluateTest, TheExcerptIsAroundTheLossOfTheModel) {
  constexpr Tick kLong_ticks = 20'000;
  Tape tape;
  tape.whole_tracking(kStart, kStart + kLong_ticks, 0.0);
  for (Tick tick = kStart; tick < kStart + kLong_ticks; ++tick) {
    tape.truth(tick, static_cast<double>(tick - kStart), 0.0);
  }
  const std::string path = tape.close();
  TrialOutcome outcome = outcome_of(1, Condition::kC, kStart);
  outcome.planned.trial.duration_ticks = kLong_ticks;
  const auto begins_s = [&] {
    const Excerpt sut = evaluate(path, {outcome}).trials.at(0).excerpt;
    EXPECT_EQ(sut.time_s.size(), 1200u);
    EXPECT_NEAR(1e-3 * sut.feedthrough_n.front(), sut.time_s.front(), 1e-9);
    return sut.time_s.front();
  };
  EXPECT_EQ(begins_s(), 0.0);
  for (const auto& [lost_s, first_s] : {std::pair{2.0, 0.0}, {6.0, 1.0}, {19.0, 8.0}}) {
    stillhand_msgs::Event event;
    event.code(stillhand_msgs::CODE_MODEL_CHANGED);
    event.tick(kStart + kLong_ticks - 1);
    event.by_us(1e6 * (19.999 - lost_s));
    outcome.marks = {mark_of(event)};
    EXPECT_NEAR(begins_s(), first_s, 1.5e-3) << lost_s;
  }
}

TEST(EvaluateTest, TheCancelledShareIsThePartThatTheMotorRemoves) {
  for (const double share : {0.0, 0.25, 1.0, 1.5}) {
    ForcedTape tape(share, 0);
    const auto sut = evaluate(tape.close(), {outcome_of(1, Condition::kC, kStart)});
    EXPECT_NEAR(sut.trials.at(0).cancelled_share, 1.0 - std::abs(1.0 - share), 1e-12);
  }
}

// A tone of f Hz that is opposed in full tau late leaves 2 sin(pi f tau) of it: 2 Hz, 10 ms.
TEST(EvaluateTest, AMotorThatComesLateCancelsLessAndItsDelayIsFound) {
  ForcedTape tape(1.0, 10);
  const auto sut = evaluate(tape.close(), {outcome_of(1, Condition::kC, kStart)});
  const double left = 2.0 * std::sin(std::numbers::pi * 2.0 * 0.010);
  // 10 whole cycles a trial: the RMS of both is exact but for rounding.
  EXPECT_NEAR(sut.trials.at(0).cancelled_share, 1.0 - left, 1e-9);
  EXPECT_NEAR(sut.trials[0].counterforce_delay_s, 0.010, 1e-4);
}

TEST(EvaluateTest, ATrialThatDoesNotMoveHasNoShareAndOneThatDoesNotCancelHasNoDelay) {
  ForcedTape tape(0.0, 0);
  const std::string path = tape.close();
  const auto still = evaluate(path, {outcome_of(1, Condition::kA, kStart)});
  EXPECT_TRUE(std::isnan(still.trials.at(0).cancelled_share));
  const auto moving = evaluate(path, {outcome_of(1, Condition::kB, kStart)});
  EXPECT_NEAR(moving.trials.at(0).cancelled_share, 0.0, 1e-12);
  EXPECT_TRUE(std::isnan(moving.trials[0].counterforce_delay_s));
  EXPECT_FALSE(moving.trials[0].sensor_to_command.has_value());
  // Without a model there is no cost of it.
  EXPECT_FALSE(moving.model.has_value());
  EXPECT_FALSE(moving.conversion.has_value());
}

// 1 us, 2 us, ... 5000 us, in another order; commands outside the trial, and one that answers no
// sample, would be the largest.
TEST(EvaluateTest, LatenciesAreQuantilesOverTheTrialsCommands) {
  ForcedTape tape(1.0, 0);
  tape.motor(kStart - 1, 1'000'000, 999'000'000);
  for (Tick n = 0; n < kTrial_ticks; ++n) {
    const std::int64_t late_us = 1 + (n * 1237) % kTrial_ticks;  // 1237 is prime: each once
    tape.motor(kStart + n, 1'000'000, 1'000'000 + 1000 * late_us);
  }
  tape.motor(kStart, 0, 999'000'000);
  tape.motor(kEnd, 1'000'000, 999'000'000);
  const auto sut = evaluate(tape.close(), {outcome_of(1, Condition::kC, kStart)});
  const auto latency = sut.trials.at(0).sensor_to_command.value();
  EXPECT_NEAR(latency.p50_us, 2500.0, 1.0);
  EXPECT_NEAR(latency.p99_us, 4950.0, 1.0);
  EXPECT_DOUBLE_EQ(latency.max_us, 5000.0);
  EXPECT_EQ(latency.uncertainty_us, 0.0);
}

// Three of four ticks use the answer to their own sample, 200 us after it; the fourth the one
// before again, and so never its own: the command that came too late is not counted as used.
TEST(EvaluateTest, TheUseOfACommandIsTheFirstStepThatNamesIt) {
  Tape tape;
  tape.whole_tracking(kStart, kEnd, 0.0);
  for (Tick tick = kStart; tick < kEnd; ++tick) {
    const std::int64_t at_ns = 1'000'000'000 + 1'000'000 * tick;
    const bool missed = tick % 4 == 3;
    tape.used(tick, at_ns, missed ? tick - 1 : tick, at_ns + 200'000);
  }
  const auto sut = evaluate(
      tape.close(), {outcome_of(1, Condition::kC, kStart), outcome_of(1, Condition::kB, kStart)});
  EXPECT_DOUBLE_EQ(sut.trials.at(0).same_tick_share.value(), 0.75);
  EXPECT_DOUBLE_EQ(sut.trials[0].sensor_to_force.value().p50_us, 200.0);
  EXPECT_DOUBLE_EQ(sut.trials[0].sensor_to_force.value().max_us, 200.0);
  EXPECT_FALSE(sut.trials.at(1).same_tick_share.has_value());
}

// The rig's clock is 5 ms ahead, the cancellation's 2 ms behind: 300 us stay 300 us.
TEST(EvaluateTest, StampsOfOtherHostsAreTakenOverToOneClock) {
  ForcedTape tape(1.0, 0);
  tape.clock("rig", 0, 5'000'000, 40'000.0);
  tape.clock("cancellation", 0, -2'000'000, 25'000.0);
  tape.clock("display", 0, 77, 1e9);
  for (Tick tick = kStart; tick < kEnd; ++tick) {
    const std::int64_t at_ns = 1'000'000'000 + 1'000'000 * tick;
    tape.motor(tick, at_ns + 5'000'000, at_ns + 300'000 - 2'000'000);
  }
  const auto sut = evaluate(tape.close(), {outcome_of(1, Condition::kC, kStart)});
  const auto latency = sut.trials.at(0).sensor_to_command.value();
  EXPECT_DOUBLE_EQ(latency.p50_us, 300.0);
  EXPECT_DOUBLE_EQ(latency.max_us, 300.0);
  EXPECT_DOUBLE_EQ(latency.uncertainty_us, 65.0);
  EXPECT_EQ(sut.clocks.at("rig").offset_ns(), 5'000'000);
  EXPECT_EQ(sut.clocks.size(), 3u);
}

stillhand_msgs::FeedthroughModel static_model(double gain, bool usable) {
  stillhand_msgs::FeedthroughModel message;
  message.fit_rate_hz(50.0);
  message.fit_numerator({gain, 0.0});
  message.fit_denominator({1.0, 0.0});
  message.control_rate_hz(1000.0);
  message.control_numerator({gain, 0.0});
  message.control_denominator({1.0, 0.0});
  message.usable(usable);
  return message;
}

// A static model that is right: at 1 kHz nothing is left, and what 50 Hz and a hold leave is
// written out here, sample by sample from the second second on.
TEST(EvaluateTest, TheCostOfAHoldIsTheErrorOfTheHeldFiftyHertzModel) {
  ForcedTape tape(0.0, 0);
  for (Tick tick = kStart; tick < kEnd; ++tick) tape.sensed(tick, acceleration_m_s2(tick));
  tape.file.add(topics::kFeedthroughModel, static_model(-3.2, true));
  const auto sut = evaluate(tape.close(), {outcome_of(1, Condition::kC, kStart)});
  support::RmsShare left;
  for (Tick n = 2000; n < kTrial_ticks; ++n) {
    const double now = acceleration_m_s2(kStart + n);
    const double held = acceleration_m_s2(kStart + n / 20 * 20);
    left.add(now - held, now);
  }
  ASSERT_TRUE(sut.conversion.has_value());
  EXPECT_NEAR(sut.conversion->control_filter, 0.0, 1e-12);
  EXPECT_NEAR(sut.conversion->zero_order_hold, left.value(), 1e-12);
}

TEST(EvaluateTest, TheNewestModelIsTakenAndAnUnusableOneIsNotJudged) {
  ForcedTape tape(0.0, 0);
  tape.file.add(topics::kFeedthroughModel, static_model(-3.2, true));
  tape.file.add(topics::kFeedthroughModel, static_model(-1.0, false));
  const auto sut = evaluate(tape.close(), {outcome_of(1, Condition::kC, kStart)});
  ASSERT_TRUE(sut.model.has_value());
  EXPECT_FALSE(sut.model->usable());
  EXPECT_FALSE(sut.conversion.has_value());
}

}  // namespace
}  // namespace stillhand::session::results_test
