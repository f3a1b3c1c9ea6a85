// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/check_options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "places.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/deploy/sample_inventory.hpp"

namespace stillhand::lab::check_options_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class CheckOptionsTest : public testing::Test {
 protected:
  CheckOptionsTest() {
    options_.protocol.conditions = session::parse_conditions("A,B");
    options_.protocol.trial_s = options_.protocol.identify_s = 5.0;
    options_.profiles = STILLHAND_SOURCE "/qos/profiles.xml";
    options_.config = STILLHAND_SOURCE "/deploy/config";
  }
  [[nodiscard]] std::string refusal() const {
    return support::refusal([&] { check_options(options_); });
  }
  /// A ride of one sine: 1 m/s^2 at 2 Hz.
  std::string ride(double seconds) {
    const auto file = folder_.path() / "ride.csv";
    std::ofstream stream(file);
    stream << "t [s],a_y [m/s^2]\n";
    for (int i = 0; i <= static_cast<int>(100.0 * seconds); ++i) {
      stream << i / 100 << '.' << i / 10 % 10 << i % 10 << ','
             << std::sin(2.0 * 3.14159265358979 * 2.0 * i / 100.0) << '\n';
    }
    return file;
  }

  deploy::SampleFolder folder_;
  LabOptions options_;
};

TEST_F(CheckOptionsTest, TheDefaultsAreTakenAndEveryMovingTrialIsRehearsed) {
  EXPECT_EQ(check_options(options_).size(), 2u);  // identification and B
}

TEST_F(CheckOptionsTest, ARigOfDevicesIsReadBeforeAnythingStarts) {
  options_.devices = options_.config / "devices.yaml";
  EXPECT_EQ(refusal(), "accepted");
  options_.undeclared_effect = 3;
  EXPECT_THAT(refusal(), StartsWith("--undeclared-effect: got it with --rig devices"));
  options_.undeclared_effect = 0;
  options_.devices = folder_.path() / "devices.yaml";
  std::ofstream(options_.devices) << "signals:\n  force: scales\n";
  EXPECT_THAT(refusal(),
              HasSubstr("devices.signals.force: got scales, want one of simulated, drive"));
  options_.devices = folder_.path() / "absent.yaml";
  EXPECT_THAT(refusal(), HasSubstr("absent.yaml"));
}

TEST_F(CheckOptionsTest, ClosingLiveRehearsesTheTrialsThatMayCome) {
  options_.close_live = true;
  EXPECT_THAT(refusal(), StartsWith("--close: got live without the condition C"));
  options_.protocol.conditions = session::parse_conditions("A,C");
  options_.protocol.trial_s = 54.0;
  EXPECT_THAT(refusal(), StartsWith("--trial-seconds: got 54 with --close live"));
  options_.protocol.trial_s = 55.0;
  EXPECT_EQ(check_options(options_).size(), 4u);  // identification and C, each of them twice
  options_.model = "m.json";
  EXPECT_THAT(refusal(), StartsWith("--close live: got --model with it"));
}

TEST_F(CheckOptionsTest, ARideAndItsMotionGoTogether) {
  options_.ride = "x.csv";
  EXPECT_THAT(refusal(), AllOf(StartsWith("--ride: got x.csv"), HasSubstr("--motion ride")));
  options_.ride.clear();
  options_.protocol.motion = motion::MotionKind::kRide;
  EXPECT_THAT(refusal(), AllOf(StartsWith("--ride: got nothing"), HasSubstr("--motion ride")));
}

TEST_F(CheckOptionsTest, ARideAsLongAsTheTrialIsTakenAndAShorterOneIsNot) {
  options_.protocol.motion = motion::MotionKind::kRide;
  options_.ride = ride(5.5);
  EXPECT_EQ(refusal(), "accepted");
  options_.ride = ride(4.5);
  EXPECT_THAT(refusal(), AllOf(HasSubstr("ride.csv: got 4.5"), HasSubstr("--trial-seconds 5")));
}

TEST_F(CheckOptionsTest, ARideAsLongAsThePlanIsTakenAndAShorterOneIsNot) {
  options_.protocol.planned = true;
  options_.protocol.identify_s = 7.0;
  options_.ride = ride(7.5);
  EXPECT_EQ(refusal(), "accepted");
  options_.ride = ride(6.5);
  EXPECT_THAT(refusal(), HasSubstr("the plan's seconds, 7"));
}

TEST_F(CheckOptionsTest, AMouseNeedsAWindow) {
  options_.who = Operator::kMouse;
  EXPECT_EQ(refusal(), "accepted");
  options_.headless = true;
  EXPECT_THAT(refusal(), AllOf(StartsWith("--operator: got mouse"), HasSubstr("--headless")));
}

// The vehicle reads the stick's angle, so what a mitigation takes off it would never reach the
// platform.
TEST_F(CheckOptionsTest, AVehicleIsRefusedWithAMitigation) {
  options_.vehicle = "first_order";
  EXPECT_EQ(refusal(), "accepted");
  options_.protocol.conditions = session::parse_conditions("A,B,signal");
  EXPECT_THAT(refusal(), AllOf(StartsWith("--vehicle: got first_order with signal, want"),
                               HasSubstr("raw stick")));
  // Those of an experiment too.
  options_.trials = session::plan(options_.protocol);
  options_.protocol.conditions = session::parse_conditions("A,B");
  EXPECT_THAT(refusal(), StartsWith("--vehicle: got first_order with signal"));
  options_.vehicle.clear();
  EXPECT_EQ(refusal(), "accepted");
}

// The process of cancellation would refuse it at the trial, after the identification.
TEST_F(CheckOptionsTest, AMitigationThatTheCancellerCannotRunIsRefusedBeforeAnythingStarts) {
  const auto conditions = [&](const char* names) {
    options_.protocol.conditions = session::parse_conditions(names);
  };
  conditions("A,B,adaptive");
  EXPECT_EQ(refusal(), "accepted");
  options_.canceller = "paper";
  EXPECT_THAT(refusal(), AllOf(StartsWith("--conditions: got adaptive with --canceller paper, "),
                               HasSubstr("1000 Hz"), testing::Not(HasSubstr("\n"))));
  // The rest runs behind the paper's chain.
  conditions(
      "low-pass,notch,model-filter,signal,lms-signal,lms-force,damping,impedance,damping+force");
  EXPECT_EQ(refusal(), "accepted");
  // The settings say the same as the word.
  options_.canceller = "now";
  options_.config = folder_.path() / "config";
  std::filesystem::copy(STILLHAND_SOURCE "/deploy/config", options_.config);
  std::ofstream(options_.config / "cancellation.yaml", std::ios::app)
      << "\nsampling:\n  model_ticks: 20\n";
  EXPECT_EQ(refusal(), "accepted");
  conditions("adaptive,damping");
  EXPECT_THAT(refusal(), StartsWith("--conditions: got adaptive, want"));
}

// They are arguments of services that run already.
TEST_F(CheckOptionsTest, ArgumentsOfTheServicesAreRefusedWhereTheyRunAlready) {
  options_.attach = true;
  EXPECT_EQ(refusal(), "accepted");
  const LabOptions good = options_;
  options_.undeclared_effect = 7;
  EXPECT_THAT(refusal(), StartsWith("--attach: "));
  options_ = good;
  options_.video = true;
  EXPECT_THAT(refusal(), StartsWith("--attach: "));
  options_ = good;
  options_.who = Operator::kMouse;
  EXPECT_THAT(refusal(), StartsWith("--attach: "));
  options_ = good;
  options_.protocol.motion = motion::MotionKind::kRoad;
  EXPECT_THAT(refusal(), StartsWith("--attach: "));
}

TEST_F(CheckOptionsTest, ADomainHasPortsUpTo232) {
  options_.domain = 232;
  EXPECT_EQ(refusal(), "accepted");
  options_.domain = 233;
  EXPECT_THAT(refusal(), AllOf(StartsWith("--domain: got 233"), HasSubstr("232")));
}

TEST_F(CheckOptionsTest, ThePatienceIsPositiveAndAtMostAnHour) {
  for (const double good_s : {1e-3, 3600.0}) {
    options_.match_s = good_s;
    EXPECT_EQ(refusal(), "accepted") << good_s;
  }
  for (const double bad_s : {0.0, -1.0, 3600.1, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    options_.match_s = bad_s;
    EXPECT_THAT(refusal(), AllOf(StartsWith("--match-seconds: "), HasSubstr("3600"))) << bad_s;
  }
}

TEST_F(CheckOptionsTest, AProfileFileThatIsMissingOrAFolderIsNamed) {
  for (const char* bad : {"/no/such/profiles.xml", STILLHAND_SOURCE "/qos"}) {
    options_.profiles = bad;
    EXPECT_THAT(refusal(), AllOf(StartsWith("--profiles: "), HasSubstr(bad)));
  }
}

}  // namespace
}  // namespace stillhand::lab::check_options_test
