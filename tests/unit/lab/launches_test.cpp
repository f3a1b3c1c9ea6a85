// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/launches.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "idl/processes.hpp"

namespace stillhand::lab::launches_test {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::Not;

class LaunchesTest : public testing::Test {
 protected:
  LaunchesTest() {
    options_.programs = "/programs";
    options_.profiles = "/profiles.xml";
    options_.config = "/config";
    options_.out = "/out";
    options_.domain = 9;
    options_.rig = 4;
  }
  [[nodiscard]] std::vector<Launch> all(const std::string& sealed = "") const {
    return launches(options_, Hosts(options_), "fedcba9876543210fedcba98", sealed);
  }
  [[nodiscard]] Launch of(const std::string& service, const std::string& sealed = "") const {
    for (const Launch& launch : all(sealed)) {
      if (launch.name == service) return launch;
    }
    ADD_FAILURE() << "no " << service;
    return {};
  }
  /// The word behind an option; "": the option is absent.
  static std::string value_of(const Launch& launch, const std::string& option) {
    const auto found = std::ranges::find(launch.arguments, option);
    if (found == launch.arguments.end() || found + 1 == launch.arguments.end()) return "";
    return *(found + 1);
  }

  LabOptions options_;
};

TEST_F(LaunchesTest, EveryProcessIsThereOnceInTheOrderOfTheStart) {
  const std::vector<Launch> list = all();
  ASSERT_EQ(list.size(), topics::kLaunchOrder.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    EXPECT_EQ(list[i].name, topics::kLaunchOrder[i]);
    EXPECT_EQ(list[i].executable, "/programs/stillhand-" + list[i].name);
    EXPECT_EQ(list[i].log, "/out/logs/" + list[i].name + ".log");
    EXPECT_THAT(list[i].host, IsEmpty());
    EXPECT_THAT(list[i].standard_input, IsEmpty());
    EXPECT_FALSE(list[i].ends_with_input);
  }
}

TEST_F(LaunchesTest, EveryProcessGetsBusSeedAndPlacesAndEndsWithTheLab) {
  options_.protocol.seed = std::uint64_t{1} << 63;
  for (const Launch& launch : all()) {
    EXPECT_EQ(value_of(launch, "--domain"), "9") << launch.name;
    EXPECT_EQ(value_of(launch, "--rig"), "4") << launch.name;
    EXPECT_EQ(value_of(launch, "--experiment"), "fedcba9876543210fedcba98") << launch.name;
    EXPECT_EQ(value_of(launch, "--seed"), "9223372036854775808") << launch.name;
    EXPECT_EQ(value_of(launch, "--profiles"), "/profiles.xml") << launch.name;
    EXPECT_EQ(value_of(launch, "--config"), "/config") << launch.name;
    EXPECT_THAT(launch.arguments, Contains("--end-with-parent")) << launch.name;
    EXPECT_THAT(launch.arguments, Contains("--real-time")) << launch.name;
    EXPECT_THAT(launch.arguments, Not(Contains("--security"))) << launch.name;
  }
}

TEST_F(LaunchesTest, ARigOfDevicesIsAnotherProgramWithTheFileOfItsDevices) {
  EXPECT_THAT(of("rig").arguments, Not(Contains("--devices")));
  options_.devices = std::filesystem::path(testing::TempDir()) / "launches_test_devices.yaml";
  std::ofstream(options_.devices) << "signals:\n  platform: plain_udp\n";
  for (const Launch& launch : all()) {
    const bool rig = launch.name == "rig";
    EXPECT_EQ(launch.executable, "/programs/stillhand-" + (rig ? "device_rig" : launch.name));
    EXPECT_EQ(value_of(launch, "--devices"), rig ? options_.devices.string() : "");
    const std::string parts = value_of(launch, "--rig-parts");
    EXPECT_EQ(parts.find("plain_udp") != std::string::npos, launch.name == "display");
  }
}

TEST_F(LaunchesTest, AVehicleIsAnotherProgramInThePlaceOfMotion) {
  options_.vehicle = "wheelchair";
  for (const Launch& launch : all()) {
    const bool motion = launch.name == "motion";
    EXPECT_EQ(launch.executable,
              "/programs/stillhand-" + (motion ? "vehicle_motion" : launch.name));
    EXPECT_EQ(value_of(launch, "--vehicle"), motion ? "wheelchair" : "");
  }
}

TEST_F(LaunchesTest, WithoutRealTimeNoProcessAsksForIt) {
  options_.real_time = false;
  for (const Launch& launch : all()) {
    EXPECT_THAT(launch.arguments, Not(Contains("--real-time"))) << launch.name;
  }
}

TEST_F(LaunchesTest, TheRecorderGetsItsFileAndItsSettings) {
  options_.keep.durability = recording::Durability::kPower;
  options_.keep.flush_interval = std::chrono::milliseconds(123);
  const Launch sut = of("recorder");
  EXPECT_EQ(value_of(sut, "--out"), "/out/session.mcap");
  EXPECT_EQ(value_of(sut, "--flush-ms"), "123");
  EXPECT_THAT(sut.arguments, Contains("--fsync"));
  EXPECT_THAT(of("motion").arguments, Not(Contains("--fsync")));
}

TEST_F(LaunchesTest, TheRecorderAloneGetsTheParticipantOfAnExperiment) {
  EXPECT_THAT(of("recorder").arguments, Not(Contains("--participant")));
  options_.experiment = {"P07", std::string(64, 'a'), "02"};
  for (const Launch& launch : all()) {
    const bool recorder = launch.name == "recorder";
    EXPECT_EQ(value_of(launch, "--participant"), recorder ? "P07" : "") << launch.name;
    EXPECT_EQ(value_of(launch, "--experiment-session"), recorder ? "02" : "") << launch.name;
  }
  EXPECT_EQ(value_of(of("recorder"), "--experiment-digest"), std::string(64, 'a'));
}

TEST_F(LaunchesTest, MotionGetsTheRideOrTheRoadWithEveryBitOfItsSpeed) {
  EXPECT_THAT(of("motion").arguments, Not(Contains("--ride")));
  options_.protocol.motion = motion::MotionKind::kRide;
  options_.ride = "rides/two words.csv";
  EXPECT_EQ(value_of(of("motion"), "--ride"), "rides/two words.csv");
  options_.protocol.motion = motion::MotionKind::kRoad;
  options_.protocol.road_class = "F";
  EXPECT_EQ(value_of(of("motion"), "--road-class"), "F");
  for (const double speed_m_s : {1.0 / 3.0, 0.1 + 0.2, 20.0}) {
    options_.protocol.road_speed_m_s = speed_m_s;
    EXPECT_EQ(std::strtod(value_of(of("motion"), "--speed-m-s").c_str(), nullptr), speed_m_s);
  }
  EXPECT_THAT(of("rig").arguments, Not(Contains("--road-class")));  // blinded, like the assignment
}

TEST_F(LaunchesTest, MotionAndCancellationGetTheSamePerturbation) {
  options_.protocol.perturb_period_s = 4.0;
  for (const bool swapped : {false, true}) {
    options_.protocol.perturb_swapped = swapped;
    for (const Launch& launch : all()) {
      const bool perturbs = launch.name == "motion" || launch.name == "cancellation";
      EXPECT_EQ(value_of(launch, "--perturb-period-s"), perturbs ? "4" : "") << launch.name;
      const auto has = Contains("--perturb-swapped");
      if (perturbs && swapped) {
        EXPECT_THAT(launch.arguments, has) << launch.name;
      } else {
        EXPECT_THAT(launch.arguments, Not(has)) << launch.name;
      }
    }
  }
}

TEST_F(LaunchesTest, AMouseIsThePointerOfDisplayAndOperator) {
  EXPECT_THAT(of("display").arguments, Not(Contains("--pointer")));
  options_.who = Operator::kMouse;
  EXPECT_THAT(of("display").arguments, Contains("--pointer"));
  EXPECT_THAT(of("human_operator").arguments, Contains("--pointer"));
  EXPECT_THAT(of("rig").arguments, Not(Contains("--pointer")));
}

TEST_F(LaunchesTest, AGamepadIsADeviceOfTheDisplayInPlaceOfTheMouse) {
  options_.who = Operator::kMouse;
  EXPECT_EQ(value_of(of("display"), "--gamepad"), "");
  options_.gamepad = "/dev/input/event5";
  EXPECT_EQ(value_of(of("display"), "--gamepad"), "/dev/input/event5");
  EXPECT_THAT(of("display").arguments, Contains("--pointer"));
  EXPECT_THAT(of("human_operator").arguments, Contains("--pointer"));
  EXPECT_THAT(of("human_operator").arguments, Not(Contains("--gamepad")));
}

TEST_F(LaunchesTest, TheDisplayAloneGetsWindowAndVideo) {
  options_.headless = options_.video = true;
  EXPECT_THAT(of("display").arguments, Contains("--headless"));
  EXPECT_EQ(value_of(of("display"), "--video"), "/out/screen.avi");
  for (const Launch& launch : all()) {
    EXPECT_EQ(value_of(launch, "--video").empty(), launch.name != "display") << launch.name;
  }
}

// Arguments appear in the machine's list of processes: the seal travels by standard input.
TEST_F(LaunchesTest, TheSealedEffectReachesTheRigAloneAndNotAsAnArgument) {
  const std::string sealed = "seed 42 nonce 0123";
  for (const Launch& launch : all(sealed)) {
    EXPECT_EQ(launch.standard_input, launch.name == "rig" ? sealed : "");
    for (const std::string& argument : launch.arguments) {
      EXPECT_EQ(argument.find("0123"), std::string::npos) << launch.name;
    }
    if (launch.name != "rig") {
      EXPECT_THAT(launch.arguments, Not(Contains("--undeclared-effect"))) << launch.name;
    }
  }
  EXPECT_THAT(of("rig", sealed).arguments, Contains("--undeclared-effect"));
  EXPECT_EQ(value_of(of("rig", sealed), "--out"), "/out");
  EXPECT_THAT(of("rig").arguments, Not(Contains("--undeclared-effect")));
}

}  // namespace
}  // namespace stillhand::lab::launches_test
