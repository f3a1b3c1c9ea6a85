// SPDX-License-Identifier: Apache-2.0
#include "apps/session/protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "services/contract/config_error.hpp"

namespace stillhand::session {
namespace {

ProtocolOptions three_conditions(std::uint64_t seed) {
  ProtocolOptions options;
  options.conditions = parse_conditions("A,B,C");
  options.trial_s = 20.0;
  options.seed = seed;
  return options;
}

std::string order_of(const std::vector<PlannedTrial>& trials) {
  std::string order;
  for (const PlannedTrial& trial : trials) order += trial.label;
  return order;
}

TEST(ProtocolTest, IdentificationComesFirstAndEachConditionOnce) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto trials = plan(three_conditions(seed));
    ASSERT_EQ(trials.size(), 4u);
    EXPECT_EQ(trials[0].label, 'I');
    EXPECT_EQ(trials[0].trial.phase, TrialPhase::kPegged);
    EXPECT_THAT(order_of(trials).substr(1), testing::UnorderedElementsAre('A', 'B', 'C'));
  }
}

TEST(ProtocolTest, EveryOrderOccursAmongSeeds) {
  // Six orders; that one is missing among 200 fair shuffles has a chance below 6 (5/6)^200 = 1e-15.
  std::set<std::string> orders;
  for (std::uint64_t seed = 0; seed < 200; ++seed)
    orders.insert(order_of(plan(three_conditions(seed))));
  EXPECT_EQ(orders.size(), 6u);
}

TEST(ProtocolTest, TheSameSeedGivesTheSamePlan) {
  const auto first = plan(three_conditions(7));
  const auto again = plan(three_conditions(7));
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].label, again[i].label);
    EXPECT_EQ(first[i].motion_seed, again[i].motion_seed);
    EXPECT_EQ(first[i].reference_seed, again[i].reference_seed);
  }
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

TEST(ProtocolTest, OnlyCMovesAndCancels) {
  for (const PlannedTrial& trial : plan(three_conditions(1))) {
    EXPECT_EQ(trial.cancellation, trial.label == 'C');
    EXPECT_EQ(trial.moving, trial.label != 'A');
  }
}

const PlannedTrial& moving_trial(const std::vector<PlannedTrial>& trials) {
  for (const PlannedTrial& trial : trials) {
    if (trial.label == 'B') return trial;
  }
  return trials.front();
}

ProtocolOptions road(const std::string& road_class, double speed_m_s) {
  ProtocolOptions options = three_conditions(1);
  options.motion = Motion::kRoad;
  options.road_class = road_class;
  options.road_speed_m_s = speed_m_s;
  return options;
}

// ISO 8608 describes 0.011 to 2.83 cycles/m, the platform follows 0.05 to 6 Hz.
TEST(ProtocolTest, ARoadKeepsToWhatTheStandardDescribesAndThePlatformFollows) {
  const auto at_20 = plan(road("B", 20.0));
  EXPECT_EQ(moving_trial(at_20).motion, Motion::kRoad);
  EXPECT_DOUBLE_EQ(moving_trial(at_20).band_low_hz, 0.22);
  EXPECT_EQ(moving_trial(at_20).band_high_hz, 6.0);
  EXPECT_EQ(moving_trial(at_20).rms_m_s2, 0.0);
  const auto at_1 = plan(road("H", 1.0));
  EXPECT_EQ(moving_trial(at_1).band_low_hz, 0.05);
  EXPECT_DOUBLE_EQ(moving_trial(at_1).band_high_hz, 2.83);
  EXPECT_EQ(at_20[0].motion, Motion::kBandNoise);  // identification, whatever the trials use
}

std::string road_error(const ProtocolOptions& options) {
  try {
    plan(options);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ProtocolTest, ARoadBeyondItsBoundsIsRefusedAndNamed) {
  for (const char* wrong : {"", "I", "b", "AB", "1"}) {
    EXPECT_THAT(road_error(road(wrong, 20.0)), testing::StartsWith("--road-class: got ")) << wrong;
  }
  for (const double wrong :
       {0.49, 70.1, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_THAT(road_error(road("A", wrong)), testing::StartsWith("--speed-m-s: got ")) << wrong;
  }
  EXPECT_EQ(road_error(road("A", 0.5)), "no error");
  EXPECT_EQ(road_error(road("H", 70.0)), "no error");
}

class BadConditionsTest : public testing::TestWithParam<const char*> {};

TEST_P(BadConditionsTest, AreRefusedAndNamed) {
  try {
    parse_conditions(GetParam());
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("--conditions: got "));
  }
}

INSTANTIATE_TEST_SUITE_P(Words, BadConditionsTest,
                         testing::Values("", "D", "A,D", "A,A", "a", "A,,B", "AB", "A B"));

class BadDurationTest : public testing::TestWithParam<double> {};

TEST_P(BadDurationTest, IsRefused) {
  ProtocolOptions options = three_conditions(1);
  options.trial_s = GetParam();
  EXPECT_THROW(plan(options), ConfigError);
  options = three_conditions(1);
  options.identify_s = GetParam();
  EXPECT_THROW(plan(options), ConfigError);
}

INSTANTIATE_TEST_SUITE_P(Seconds, BadDurationTest,
                         testing::Values(-1.0, 0.0, 4.9, 3601.0,
                                         std::numeric_limits<double>::infinity(),
                                         std::numeric_limits<double>::quiet_NaN()));

}  // namespace
}  // namespace stillhand::session
