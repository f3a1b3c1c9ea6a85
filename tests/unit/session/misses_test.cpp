// SPDX-License-Identifier: Apache-2.0
// Sessions whose stamps the test has written.
#include "apps/libraries/session/misses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/contract/tick.hpp"

namespace stillhand::session::misses_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr Tick kTicks = 5000;
constexpr Tick kTrialStart = 500;

/// [from, until): the ticks in which a process writes nothing; what waits is written at its end.
struct Stop {
  std::string process;
  Tick from, until;
};

bool stands(const std::vector<Stop>& stops, const std::string& process, Tick tick) {
  return std::ranges::any_of(stops, [&](const Stop& each) {
    return each.process == process && tick >= each.from && tick < each.until;
  });
}

// Each process answers 0.1 ms after its source; who stood answers all that waited at once.
SessionRecording session(const std::vector<Stop>& stops) {
  SessionRecording out;
  const auto stamp = [&](const std::string& process, Tick tick, std::int64_t source_ns) {
    std::int64_t at_ns = source_ns;
    for (const Stop& each : stops) {
      if (each.process == process && tick >= each.from && tick < each.until) {
        at_ns = std::max(at_ns, each.until * kTick_ns);
      }
    }
    return at_ns + kTick_ns / 10;
  };
  const auto add = [](auto& list, Tick tick, std::int64_t at_ns) -> auto& {
    auto& message = list.emplace_back();
    message.tick(tick);
    message.stamp_ns(at_ns);
    return message;
  };
  stillhand_msgs::TrialControl control;
  control.trial(3);
  control.phase(stillhand_msgs::PHASE_TRACKING);
  control.start_tick(kTrialStart);
  control.duration_ticks(4000);
  control.ramp_ticks(100);
  out.trial_controls.push_back(control);
  for (Tick tick = 0; tick < kTicks; ++tick) {
    const std::int64_t raw_ns = stamp("rig", tick, tick * kTick_ns);
    add(out.raw_samples, tick, raw_ns);
    const std::int64_t sensed_ns = stamp("sensing", tick, raw_ns);
    add(out.sensed, tick, sensed_ns);
    add(out.platform_commands, tick, stamp("motion", tick, sensed_ns));
    const double predicted_n =
        5.0 * std::sin(2.0 * std::numbers::pi * 2e-3 * static_cast<double>(tick));
    auto& command = add(out.motor_commands, tick, stamp("cancellation", tick, sensed_ns));
    command.predicted_force_n(predicted_n);
    const std::int64_t shown_ns = stamp("display", tick, sensed_ns);
    add(out.tracking_samples, tick, shown_ns);
    add(out.operator_forces, tick, stamp("human_operator", tick, shown_ns));
    auto& truth = add(out.rig_truths, tick, raw_ns);
    truth.motor_tick(tick);
    // Zero as long as sensing stands.
    truth.motor_force_n(stands(stops, "sensing", tick) ? 0.0 : -predicted_n);
  }
  return out;
}

TEST(MissesTest, ASessionInTimeHasNone) {
  EXPECT_THAT(misses_in(session({})), IsEmpty());
  EXPECT_THAT(misses_in(session({{"sensing", 2000, 2004}})), IsEmpty()) << "less than 5 ms";
  EXPECT_THAT(misses_in(session({{"sensing", 2000, 2006}})), SizeIs(1));
}

TEST(MissesTest, WhoStandsIsNamedWithTimeLengthForceAndWhoWaited) {
  SessionRecording recording = session({{"sensing", 2000, 2073}});
  recording.log_less_stamp_ns = 5'000'000'000;
  recording.first_log_ns = 4'000'000'000;
  const auto sut = misses_in(recording);
  ASSERT_THAT(sut, SizeIs(1));
  const Miss& miss = sut.front();
  EXPECT_EQ(miss.process, "sensing");
  EXPECT_EQ(miss.topic, "stillhand/sensed");
  EXPECT_EQ(miss.trial, 3);
  EXPECT_NEAR(miss.trial_s, 1.5, 1e-3);
  // 2 s and 1 s; sensing answers 0.2 ms after a tick, the last time in tick 1999.
  EXPECT_NEAR(miss.from_s, 2.9997, 1e-9);
  EXPECT_FALSE(miss.pegged);
  EXPECT_NEAR(miss.late_s, 0.073, 0.5e-3 + 1e-12);  // Eq. MI-1: half a tick
  EXPECT_THAT(miss.waited, ElementsAre("motion", "cancellation", "display", "human_operator"));
  EXPECT_NEAR(miss.force_before_n, 5.0 / std::sqrt(2.0), 0.05);
  EXPECT_NEAR(miss.zero_s, 0.073, 2e-3);
  // It is looked at in steps of 10 ms.
  EXPECT_NEAR(miss.back_s, 0.073, 11e-3);
  EXPECT_EQ(what_happened(miss),
            "sensing was late by 73 ms, force 0 for 0.07 s, whole again after 0.1 s");
}

TEST(MissesTest, EachProcessIsNamedForItself) {
  for (const std::string process :
       {"rig", "sensing", "motion", "cancellation", "display", "human_operator"}) {
    const auto sut = misses_in(session({{process, 2000, 2040}}));
    ASSERT_THAT(sut, SizeIs(1)) << process;
    EXPECT_EQ(sut.front().process, process);
    EXPECT_NEAR(sut.front().late_s, 0.040, 0.5e-3 + 1e-12) << process;
  }
}

TEST(MissesTest, TwoThatStandOneAfterTheOtherAreTwo) {
  const auto sut = misses_in(session({{"cancellation", 1000, 1020}, {"sensing", 3000, 3030}}));
  ASSERT_THAT(sut, SizeIs(2));
  EXPECT_EQ(sut[0].process, "cancellation");
  EXPECT_EQ(sut[1].process, "sensing");
}

// Sensing comes back after 20 ms, and cancellation stands for another 60.  A source that was silent
// for at least half of the gap (45 of 80 ms) takes all of it.
TEST(MissesTest, WhoStandsLongerThanItsSourceIsLateByItself) {
  const auto sut = misses_in(session({{"sensing", 2000, 2020}, {"cancellation", 2000, 2080}}));
  ASSERT_THAT(sut, SizeIs(2));
  EXPECT_EQ(std::min(sut[0].late_s, sut[1].late_s) < 0.03, true);
  EXPECT_NEAR(std::max(sut[0].late_s, sut[1].late_s), 0.08, 1e-3);
  EXPECT_THAT(misses_in(session({{"sensing", 2000, 2045}, {"cancellation", 2000, 2080}})),
              SizeIs(1));
}

TEST(MissesTest, OtherClocksAreConverted) {
  SessionRecording recording = session({{"sensing", 2000, 2073}});
  constexpr std::int64_t kAhead_ns = 7'000'000'000;
  for (auto& sample : recording.motor_commands) sample.stamp_ns(sample.stamp_ns() + kAhead_ns);
  stillhand_msgs::ClockOffset offset;
  offset.service("cancellation");
  offset.offset_ns(kAhead_ns);
  recording.clock_offsets.push_back(offset);
  const auto sut = misses_in(recording);
  ASSERT_THAT(sut, SizeIs(1));
  EXPECT_EQ(sut.front().process, "sensing");
}

// The recorder stood, or the network to it was slow: the rig counts without a jump.
TEST(MissesTest, WhatTheRecordingLacksIsNobodysSilence) {
  const auto cut = [](auto& stream) {
    std::erase_if(stream,
                  [](const auto& each) { return each.tick() > 2000 && each.tick() < 2060; });
  };
  SessionRecording all = session({});
  cut(all.raw_samples);
  cut(all.sensed);
  cut(all.platform_commands);
  cut(all.motor_commands);
  cut(all.tracking_samples);
  cut(all.operator_forces);
  cut(all.rig_truths);
  EXPECT_THAT(misses_in(all), IsEmpty());
  SessionRecording one = session({});
  cut(one.motor_commands);  // which the rig used
  EXPECT_THAT(misses_in(one), IsEmpty());
  cut(one.sensed);
  EXPECT_THAT(misses_in(one), IsEmpty());
}

TEST(MissesTest, AForceThatIsNotThePredictionsIsNotJudged) {
  SessionRecording recording = session({{"sensing", 2000, 2073}});
  for (auto& command : recording.motor_commands) command.predicted_force_n(0.0);
  recording.trial_controls[0].phase(stillhand_msgs::PHASE_PEGGED);
  const auto sut = misses_in(recording);
  ASSERT_THAT(sut, SizeIs(1));
  EXPECT_TRUE(sut.front().pegged);
  EXPECT_GT(sut.front().force_before_n, 1.0);
  EXPECT_EQ(sut.front().back_s, 0.0);
}

TEST(MissesTest, TheForceIsJudgedToTheEndOfTheTrial) {
  SessionRecording recording = session({{"sensing", 4400, 4473}});
  for (auto& truth : recording.rig_truths) {
    if (truth.tick() > 4400 && truth.tick() < 4800) truth.motor_force_n(0.0);
  }
  const auto sut = misses_in(recording);
  ASSERT_THAT(sut, SizeIs(1));
  EXPECT_NEAR(sut.front().zero_s, 0.1, 2e-3);  // the trial ends at tick 4500
  EXPECT_TRUE(std::isnan(sut.front().back_s));
  EXPECT_THAT(what_happened(sut.front()),
              testing::HasSubstr("force not whole again in this trial"));
}

// The stall of sensing, and a motor force of the test's own: `force(tick, f')` [N].
template <typename Force>
Miss miss_with(Force force, const Stop& stop = {"sensing", 2000, 2073}) {
  SessionRecording recording = session({stop});
  for (std::size_t n = 0; n < recording.rig_truths.size(); ++n) {
    auto& truth = recording.rig_truths[n];
    truth.motor_force_n(force(truth.tick(), recording.motor_commands[n].predicted_force_n()));
  }
  const auto sut = misses_in(recording);
  EXPECT_THAT(sut, SizeIs(1));
  return sut.at(0);
}

TEST(MissesTest, TheForceBeforeIsThatOfTheSecondBefore) {
  const auto before_n = [](Tick first) {
    return miss_with([&](Tick tick, double f) { return tick < first ? 0.0 : -f; }).force_before_n;
  };
  EXPECT_NEAR(before_n(1000), 5.0 / std::sqrt(2.0), 0.02);
  EXPECT_NEAR(before_n(1500), 5.0 / 2.0, 0.02);
}

TEST(MissesTest, AForceOfLessThanAMillinewtonIsNone) {
  const auto zero_s = [](double rms_n) {
    const double part = rms_n * std::sqrt(2.0) / 5.0;
    return miss_with(
               [&](Tick tick, double f) { return tick >= 2000 && tick < 2073 ? 0.0 : -part * f; })
        .zero_s;
  };
  EXPECT_EQ(zero_s(0.9e-3), 0.0);
  EXPECT_NEAR(zero_s(1.1e-3), 0.073, 2e-3);
}

TEST(MissesTest, TheForceIsWholeAgainFrom97PercentOfItsShareOn) {
  const auto back_s = [](double part) {
    return miss_with([&](Tick tick, double f) {
             return tick < 2000 ? -0.5 * f : tick < 2200 ? 0.0 : -0.5 * part * f;
           })
        .back_s;
  };
  EXPECT_TRUE(std::isnan(back_s(0.96)));
  // Looked at in windows of 100 ms, of which all is whole.
  EXPECT_NEAR(back_s(0.98), 0.2, 11e-3);
}

TEST(MissesTest, ATenthOfSomethingElseMakesTheForceNotThePredictions) {
  const auto back_s = [](double other) {
    return miss_with([&](Tick tick, double f) {
             const double across_n =
                 5.0 * std::cos(2.0 * std::numbers::pi * 2e-3 * static_cast<double>(tick));
             return -f + other * across_n;
           })
        .back_s;
  };
  EXPECT_GT(back_s(0.095), 0.0);
  EXPECT_EQ(back_s(0.105), 0.0);
}

// The ramp to zero takes 50 ms: a zero that comes later is the prediction's own.
TEST(MissesTest, AForceIsZeroForTheStallWithinTheRampAlone) {
  const auto zero_s = [](Tick first) {
    return miss_with(
               [&](Tick tick, double) { return tick >= first && tick < first + 20 ? 0.0 : 1.0; })
        .zero_s;
  };
  EXPECT_NEAR(zero_s(2118), 0.020, 1e-9);
  EXPECT_EQ(zero_s(2126), 0.0);
}

// Of another silence, another process, or another length, it says nothing of this one.
TEST(MissesTest, TheReasonIsWhatTheProcessSaidOfThisSilence) {
  const auto why = [](const std::string& source, Tick said_at, double by_us) {
    SessionRecording recording = session({{"sensing", 2000, 2073}});
    auto& event = recording.events.emplace_back();
    event.code(stillhand_msgs::CODE_STALL);
    event.source(source);
    event.stamp_ns(said_at * kTick_ns);
    event.by_us(by_us);
    event.text("stopped by a signal");
    return misses_in(recording).at(0).why;
  };
  EXPECT_EQ(why("sensing", 2200, 73'400), "stopped by a signal");
  EXPECT_EQ(why("cancellation", 2200, 73'400), "");
  EXPECT_EQ(why("sensing", 1900, 73'400), "");
  EXPECT_EQ(why("sensing", 3100, 73'400), "") << "more than a second later";
  EXPECT_EQ(why("sensing", 2200, 20'000), "");
  // Within a fifth of its length.
  EXPECT_EQ(why("sensing", 2200, 87'000), "stopped by a signal");
  EXPECT_EQ(why("sensing", 2200, 88'500), "");
  EXPECT_EQ(why("sensing", 2062, 73'400), "stopped by a signal");
  EXPECT_EQ(why("sensing", 2055, 73'400), "");
}

TEST(MissesTest, AnEmptyRecordingHasNone) { EXPECT_THAT(misses_in({}), IsEmpty()); }

}  // namespace
}  // namespace stillhand::session::misses_test
