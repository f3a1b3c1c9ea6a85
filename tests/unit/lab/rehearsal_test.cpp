// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/rehearsal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::lab::rehearsal_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kTrial_s = 10.0;

class RehearsalTest : public testing::Test {
 protected:
  RehearsalTest() {
    write("motion.yaml", "");
    write("display.yaml", "");
    options.conditions = session::parse_conditions("A,B,C");
    options.trial_s = kTrial_s;
    options.identify_s = kTrial_s;
  }
  void write(const std::string& name, const std::string& yaml) const {
    std::ofstream(config / name) << yaml;
  }
  [[nodiscard]] std::string refusal(const motion::RideRecord& ride = {}) const {
    return support::refusal([&] { rehearse(session::plan(options), options, ride, config); });
  }
  [[nodiscard]] std::vector<session::PlannedTrial> trials() const { return session::plan(options); }

  session::ProtocolOptions options;
  const support::Folder config;
};

// One sine, which the platform can follow when it is fast and small enough.
motion::RideRecord sine(double m_s2, double hz, double seconds) {
  motion::RideRecord ride{100.0, {}, "ride.csv"};
  for (int i = 0; i < static_cast<int>(seconds * ride.rate_hz); ++i) {
    ride.accel_m_s2.push_back(m_s2 * std::sin(2.0 * std::numbers::pi * hz * i / ride.rate_hz));
  }
  return ride;
}

TEST_F(RehearsalTest, EveryTrialThatMovesIsAskedForAndNoOther) {
  const AskedMotions sut = rehearse(session::plan(options), options, {}, config);
  for (const session::PlannedTrial& trial : trials()) {
    EXPECT_EQ(sut.count(trial.trial.number), trial.moving ? 1u : 0u)
        << session::name_of(trial.label);
  }
  for (const session::PlannedTrial& trial : trials()) {
    if (!trial.moving) continue;
    EXPECT_NEAR(sut.at(trial.trial.number).rms_m_s2, trial.rms_m_s2, 1e-9);
  }
}

// At 20 m/s class B comes to 1.2 m/s^2 (rehearsed, not refused), class E to 9.6, beyond any peak of
// 7.5.
TEST_F(RehearsalTest, ARoadThatThePlatformCannotFollowIsRefusedByClassAndSpeed) {
  options.motion = motion::MotionKind::kRoad;
  EXPECT_EQ(refusal(), "accepted");
  options.road_class = "E";
  EXPECT_THAT(refusal(), AllOf(StartsWith("--road-class: got E at 20 m/s, want "), HasSubstr("7.5"),
                               HasSubstr("less speed")));
}

TEST_F(RehearsalTest, ARideThatThePlatformCannotFollowIsRefused) {
  options.motion = motion::MotionKind::kRide;
  EXPECT_EQ(refusal(sine(1.0, 2.0, kTrial_s)), "accepted");
  EXPECT_THAT(refusal(sine(1000.0, 5.0, kTrial_s)), StartsWith("ride.csv: got "));
  EXPECT_THAT(refusal(sine(0.0, 2.0, kTrial_s)),
              AllOf(StartsWith("ride.csv: "), HasSubstr("no motion")));
}

TEST_F(RehearsalTest, WhatIsRemovedOfARideIsKnownBeforehand) {
  options.motion = motion::MotionKind::kRide;
  // 1 m/s^2 at 0.1 Hz needs 2.5 m of travel and goes; at 2 Hz it stays: half of the variance.
  motion::RideRecord both = sine(1.0, 2.0, kTrial_s);
  const motion::RideRecord slow = sine(1.0, 0.1, kTrial_s);
  for (std::size_t i = 0; i < both.accel_m_s2.size(); ++i) both.accel_m_s2[i] += slow.accel_m_s2[i];
  for (const auto& [number, sut] : rehearse(session::plan(options), options, both, config)) {
    if (number == 0) continue;  // identification
    EXPECT_NEAR(sut.removed_share, 0.5, 0.05);
    EXPECT_GT(sut.corner_hz, 0.1);
  }
}

TEST_F(RehearsalTest, LimitsThatForbidTheNoiseAreRefused) {
  write("motion.yaml", "limits:\n  max_position_m: 0.01\n");
  EXPECT_THAT(refusal(), AllOf(StartsWith("motion.yaml: got "), HasSubstr("trial 0 (I)")));
}

TEST_F(RehearsalTest, ATargetThatLeavesTheScreenIsRefused) {
  write("display.yaml", "reference_scale_m: 0.5\n");
  EXPECT_THAT(refusal(), HasSubstr("reference_scale_m"));
}

}  // namespace
}  // namespace stillhand::lab::rehearsal_test
