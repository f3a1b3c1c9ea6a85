// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::session::protocol_test {
namespace {

ProtocolOptions three_conditions(std::uint64_t seed) {
  return {.conditions = parse_conditions("A,B,C"), .trial_s = 20.0, .seed = seed};
}

std::string order_of(const std::vector<PlannedTrial>& trials) {
  std::string order;
  for (const PlannedTrial& trial : trials) order += name_of(trial.label);
  return order;
}

TEST(ProtocolTest, IdentificationComesFirstAndEachConditionOnce) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto trials = plan(three_conditions(seed));
    ASSERT_EQ(trials.size(), 4u);
    EXPECT_EQ(trials[0].label, Condition::kIdentification);
    EXPECT_EQ(trials[0].trial.phase, TrialPhase::kPegged);
    EXPECT_THAT(order_of(trials).substr(1), testing::UnorderedElementsAre('A', 'B', 'C'));
  }
}

TEST(ProtocolTest, APlannedRunIsThePeggedTrialAloneInTheMotionOfARide) {
  ProtocolOptions options;
  options.planned = true;
  options.identify_s = 30.0;
  const auto trials = plan(options);
  ASSERT_EQ(trials.size(), 1u);
  EXPECT_EQ(trials[0].trial.phase, TrialPhase::kPegged);
  const motion::MotionProfile sut = motion_profile(trials[0]);
  EXPECT_EQ(sut.kind, motion::MotionKind::kRide);
  EXPECT_EQ(sut.duration_ticks, 30'000);
  EXPECT_EQ(sut.rms_m_s2, 0.0);
  // The peak stays that of the pegged trial, the band that of a ride.
  EXPECT_DOUBLE_EQ(sut.peak_m_s2, 0.75 * 9.80665);
  EXPECT_DOUBLE_EQ(sut.band_high_hz, 6.0);
  EXPECT_EQ(sut.band_low_hz, 0.05);
  EXPECT_EQ(sut.band_order, 0);
}

TEST(ProtocolTest, EveryOrderOccursAmongSeeds) {
  // Six orders; that one is missing among 200 fair shuffles has a chance below 6 (5/6)^200 = 1e-15.
  std::set<std::string> orders;
  for (std::uint64_t seed = 0; seed < 200; ++seed)
    orders.insert(order_of(plan(three_conditions(seed))));
  EXPECT_EQ(orders.size(), 6u);
}

TEST(ProtocolTest, NoTwoTrialsShareMotionOrTarget) {
  const auto trials = plan(three_conditions(1));
  std::set<std::uint64_t> motions;
  std::set<std::uint64_t> targets;
  for (const PlannedTrial& trial : trials) {
    motions.insert(trial.motion_seed);
    targets.insert(trial.reference_seed);
  }
  EXPECT_EQ(motions.size(), trials.size());
  EXPECT_EQ(targets.size(), trials.size());  // the pegged trial's is 0
}

TEST(ProtocolTest, APerturbedTrialIsOnThePegAndWithoutTheMotorIfTheStickIsHeld) {
  for (const bool held : {false, true}) {
    const ProtocolOptions options{.conditions = {Condition::kP}, .stick_held = held};
    const PlannedTrial sut = plan(options).back();
    EXPECT_EQ(sut.trial.phase, held ? TrialPhase::kPegged : TrialPhase::kTracking);
    EXPECT_EQ(sut.cancellation, !held);
    EXPECT_EQ(sut.motion, motion::MotionKind::kMultisine);
  }
}

const PlannedTrial& moving_trial(const std::vector<PlannedTrial>& trials) {
  for (const PlannedTrial& trial : trials) {
    if (trial.label == Condition::kB) return trial;
  }
  return trials.front();
}

ProtocolOptions road(const std::string& road_class, double speed_m_s) {
  ProtocolOptions options = three_conditions(1);
  options.motion = motion::MotionKind::kRoad;
  options.road_class = road_class;
  options.road_speed_m_s = speed_m_s;
  return options;
}

// ISO 8608 describes 0.011 to 2.83 cycles/m, the platform follows 0.05 to 6 Hz.
TEST(ProtocolTest, ARoadKeepsToWhatTheStandardDescribesAndThePlatformFollows) {
  const auto at_20 = plan(road("B", 20.0));
  EXPECT_EQ(moving_trial(at_20).motion, motion::MotionKind::kRoad);
  EXPECT_DOUBLE_EQ(moving_trial(at_20).band_low_hz, 0.22);
  EXPECT_EQ(moving_trial(at_20).band_high_hz, 6.0);
  EXPECT_EQ(moving_trial(at_20).rms_m_s2, 0.0);
  const auto at_1 = plan(road("H", 1.0));
  EXPECT_EQ(moving_trial(at_1).band_low_hz, 0.05);
  EXPECT_DOUBLE_EQ(moving_trial(at_1).band_high_hz, 2.83);
  // Identification, whatever the trials use.
  EXPECT_EQ(at_20[0].motion, motion::MotionKind::kBandNoise);
}

std::string road_error(const ProtocolOptions& options) {
  return support::refusal([&] { plan(options); });
}

TEST(ProtocolTest, ARoadBeyondItsBoundsIsRefusedAndNamed) {
  for (const char* wrong : {"", "I", "b", "AB", "1"}) {
    EXPECT_THAT(road_error(road(wrong, 20.0)), testing::StartsWith("--road-class: got ")) << wrong;
  }
  for (const double wrong :
       {0.49, 70.1, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_THAT(road_error(road("A", wrong)), testing::StartsWith("--speed-m-s: got ")) << wrong;
  }
  EXPECT_EQ(road_error(road("A", 0.5)), "accepted");
  EXPECT_EQ(road_error(road("H", 70.0)), "accepted");
}

TEST(ProtocolTest, BadConditionsAreRefusedAndNamed) {
  for (const char* text : {"", "D", "F", "G", "A,D", "A,A", "a", "A,,B", "AB", "A B"}) {
    EXPECT_THAT(support::refusal([&] { parse_conditions(text); }),
                testing::StartsWith("--conditions: got "));
  }
}

TEST(ProtocolTest, ABadDurationIsRefused) {
  for (const double seconds : {-1.0, 0.0, 4.9, 3601.0, std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()}) {
    for (const auto of : {&ProtocolOptions::trial_s, &ProtocolOptions::identify_s}) {
      ProtocolOptions options = three_conditions(1);
      options.*of = seconds;
      EXPECT_THROW(plan(options), ConfigError) << seconds;
    }
  }
}

// "got 3600, want 5 to 3600 seconds" would leave the operator without the reason.
TEST(ProtocolTest, ARefusedNumberIsShownWithTheDigitsThatMakeItWrong) {
  ProtocolOptions options = three_conditions(1);
  options.trial_s = 3600.0001;
  EXPECT_THAT(road_error(options), testing::StartsWith("--trial-seconds: got 3600.0001, "));
  EXPECT_THAT(road_error(road("A", 70.000001)),
              testing::StartsWith("--speed-m-s: got 70.000001, "));
}

TEST(ProtocolTest, TheShortestAndTheLongestTrialAreAccepted) {
  ProtocolOptions options = three_conditions(1);
  options.trial_s = 5.0;
  options.identify_s = 3600.0;
  const auto trials = plan(options);
  EXPECT_EQ(trials[0].trial.duration_ticks, 3'600'000);
  EXPECT_EQ(trials[1].trial.duration_ticks, 5'000);
  EXPECT_EQ(trials[1].trial.ramp_ticks, 2'000);
}

// Paper III-A: 0.7 to 4 Hz, peak 0.75 g; III-C: 0.7 to 2 Hz, 1.6 m/s^2 RMS, 7.5 m/s^2 peak.
TEST(ProtocolTest, TheMotionIsThePapers) {
  const auto trials = plan(three_conditions(1));
  EXPECT_EQ(trials[0].band_low_hz, 0.7);
  EXPECT_EQ(trials[0].band_high_hz, 4.0);
  EXPECT_NEAR(trials[0].peak_m_s2, 7.355, 5e-4);
  EXPECT_DOUBLE_EQ(trials[0].rms_m_s2, 0.75 * 9.80665 / 3.8);
  EXPECT_EQ(motion_profile(trials[0]).band_order, 4);
  EXPECT_EQ(motion_profile(trials[0]).band_low_hz, 0.7);
  const PlannedTrial& moving = moving_trial(trials);
  EXPECT_EQ(moving.band_low_hz, 0.7);
  EXPECT_EQ(moving.band_high_hz, 2.0);
  EXPECT_EQ(moving.rms_m_s2, 1.6);
  EXPECT_EQ(moving.peak_m_s2, 7.5);
}

TEST(ProtocolTest, TheHigherHalfOfASeedCounts) {
  const auto low = plan(three_conditions(1));
  const auto high = plan(three_conditions(1 + (std::uint64_t{1} << 32)));
  EXPECT_NE(low[0].motion_seed, high[0].motion_seed);
  EXPECT_NE(low[1].reference_seed, high[1].reference_seed);
}

// The first word of a seed_seq of the halves of the seed, the use and the trial's number: a session
// of that seed is repeated by it.
TEST(ProtocolTest, EveryUseOfTheSeedHasAStreamOfItsOwn) {
  const std::uint64_t seed = (std::uint64_t{3} << 32) + 5;
  const auto derived = [](std::uint32_t use, std::uint32_t number) {
    std::seed_seq mix{5u, 3u, use, number};
    std::uint32_t word = 0;
    mix.generate(&word, &word + 1);
    return word;
  };
  const auto trials = plan(three_conditions(seed));
  EXPECT_EQ(trials[0].motion_seed, derived(3, 0));
  EXPECT_EQ(trials[2].motion_seed, derived(3, 2));
  EXPECT_EQ(trials[2].reference_seed, derived(2, 2));
  EXPECT_EQ(repeat_seed(seed, 7), derived(4, 7));
  const PlannedTrial again = identification_again(three_conditions(seed), 9);
  EXPECT_EQ(again.motion_seed, derived(3, 9));
  EXPECT_EQ(again.trial.number, 9);
}

TEST(ProtocolTest, AMitigationIsKnownByItsAliasBehindAllAndRefusedTwice) {
  EXPECT_THAT(known_conditions(kMitigations), testing::StartsWith("all, none, force, arm-rest, "));
  EXPECT_THAT(known_conditions(kStudyConditions),
              testing::StartsWith("A (stationary), B (moving)"));
  const auto refusal = [](const char* text) {
    return support::refusal([&] { parse_conditions(text, kMitigations); });
  };
  EXPECT_THAT(refusal("C,force"), testing::HasSubstr("none is B, and force is C"));
  EXPECT_THAT(refusal("force,C"), testing::EndsWith("each condition once"));
}

TEST(ProtocolTest, TrialsAreNumberedInTheirOrder) {
  const auto trials = plan(three_conditions(5));
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_EQ(trials[i].trial.number, static_cast<std::int64_t>(i));
  }
}

TEST(ProtocolTest, OfAStudysConditionsOnlyCCancelsAndOnlyDFilters) {
  const ProtocolOptions options{.conditions = parse_conditions("F,E,D,C,B,A", kStudyConditions)};
  const auto trials = plan(options);
  ASSERT_EQ(trials.size(), 7u);
  for (const PlannedTrial& trial : trials) {
    EXPECT_EQ(trial.cancellation, trial.label == Condition::kC) << name_of(trial.label);
    EXPECT_EQ(trial.command_filter, trial.label == Condition::kD) << name_of(trial.label);
    EXPECT_EQ(trial.moving, trial.label != Condition::kA) << name_of(trial.label);
  }
}

TEST(MotionProfileTest, IsStillWhereThePlatformDoesNotMove) {
  for (const PlannedTrial& trial : plan(three_conditions(1))) {
    const motion::MotionProfile sut = motion_profile(trial);
    EXPECT_EQ(sut.kind, trial.label == Condition::kA ? motion::MotionKind::kStill
                                                     : motion::MotionKind::kBandNoise);
    EXPECT_EQ(sut.seed, trial.motion_seed);
    EXPECT_EQ(sut.rms_m_s2, trial.rms_m_s2);
    EXPECT_EQ(sut.peak_m_s2, trial.peak_m_s2);
    EXPECT_EQ(sut.duration_ticks, trial.trial.duration_ticks);
    EXPECT_EQ(sut.ramp_ticks, trial.trial.ramp_ticks);
  }
}

TEST(MotionProfileTest, ARoadAndARideStayWhatTheyAre) {
  EXPECT_EQ(motion_profile(moving_trial(plan(road("C", 10.0)))).kind, motion::MotionKind::kRoad);
  ProtocolOptions options = three_conditions(1);
  options.motion = motion::MotionKind::kRide;
  const motion::MotionProfile sut = motion_profile(moving_trial(plan(options)));
  EXPECT_EQ(sut.kind, motion::MotionKind::kRide);
  EXPECT_EQ(sut.band_low_hz, 0.05);
  EXPECT_EQ(sut.band_high_hz, 6.0);
}

TEST(CheckSeedTest, EveryWholeNumberOfSixtyThreeBitsIsOne) {
  for (const char* word : {"0", "1", "007", "9223372036854775807"}) {
    EXPECT_EQ(check_seed(word), "") << word;
  }
}

TEST(CheckSeedTest, AnythingElseIsRefusedWithTheWordAndTheLargest) {
  for (const char* word : {"", "-1", "+1", " 1", "1 ", "1.0", "1e3", "0x10", "one",
                           "9223372036854775808", "99999999999999999999999"}) {
    EXPECT_THAT(check_seed(word),
                testing::AllOf(testing::HasSubstr(word), testing::HasSubstr("9223372036854775807")))
        << word;
  }
}

}  // namespace
}  // namespace stillhand::session::protocol_test
