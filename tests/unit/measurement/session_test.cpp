// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <limits>

#include "apps/libraries/measurement/read.hpp"
#include "apps/libraries/measurement/session_trials.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/flag.hpp"
#include "services/files/recording/file_io.hpp"
#include "tests/support/recorded_file.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/session_file.hpp"

namespace stillhand::measurement::session_test {

using diagnosis::Measurement;
using stillhand_msgs::MOTION_BAND_NOISE;
using stillhand_msgs::MOTION_STILL;
using stillhand_msgs::PHASE_PEGGED;
using stillhand_msgs::PHASE_TRACKING;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using tests::SessionFile;

std::string file_of(const std::vector<std::byte>& bytes) {
  const std::string path =
      testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name() + ".mcap";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  return path;
}

void run_ticks(SessionFile& file, std::int64_t first, std::int64_t end, bool tracking = true) {
  for (std::int64_t tick = first; tick < end; ++tick) {
    file.sensed(tick);
    if (tracking) file.tracking(tick);
  }
}

// Identification of 200 ticks, B of 300, A of 400, with a ramp of 20 ticks around each.
std::vector<std::byte> session(bool of_experiment = false) {
  SessionFile file(16384);
  if (of_experiment) file.metadata("stillhand.experiment", {{"participant", "P01"}});
  file.assignment(0, MOTION_BAND_NOISE, false);
  file.control(0, PHASE_PEGGED, 100, 200);
  run_ticks(file, 0, 320);
  file.assignment(1, MOTION_BAND_NOISE, false);
  file.control(1, PHASE_TRACKING, 400, 300);
  run_ticks(file, 320, 720);
  file.assignment(2, MOTION_STILL, false);
  file.control(2, PHASE_TRACKING, 800, 400);
  run_ticks(file, 720, 1220);
  file.control(-1);
  return file.close();
}

std::string error_of(const std::string& path, const std::string& trial = {}) {
  return support::refusal([&] { (void)read_measurement(path, {trial}); });
}

std::vector<std::string> names_of(const Measurement& measurement) {
  std::vector<std::string> names;
  for (const auto& c : measurement.channels) names.push_back(c.name + " [" + c.unit + "]");
  return names;
}

TEST(SessionTest, TheMeasuredPartOfTheIdentificationIsTakenUnlessTold) {
  const Measurement sut = read_measurement(file_of(session()));
  check(sut);
  EXPECT_EQ(sut.rate_hz, 1000.0);
  EXPECT_EQ(sut.size(), 200u);
  EXPECT_DOUBLE_EQ(sut.stretches[0].start_s, 0.1);
  EXPECT_THAT(names_of(sut), ElementsAre("a_x [m/s^2]", "a_y [m/s^2]", "a_z [m/s^2]", "roll [rad]",
                                         "theta [rad]", "omega [rad/s]", "f [N]"));
  const double t = 0.299;
  const double factors[]{1.0, 2.0, 3.0, 4.0, 6.0, 7.0, 5.0};
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_DOUBLE_EQ(sut.channels[i].values.back(), factors[i] * t) << sut.channels[i].name;
  }
  EXPECT_THAT(sut.notes, ElementsAre("Trial 0 (I, 0.2 s) of the session; there are also "
                                     "1 (B, 0.3 s), 2 (A, 0.4 s)."));
}

// Blinding protects against reading a condition by accident.
TEST(SessionTest, ATrialOfAnExperimentDoesNotNameItsCondition) {
  const std::string path = file_of(session(true));
  EXPECT_THAT(
      read_measurement(path).notes,
      ElementsAre("Trial 0 (I, 0.2 s) of the session; there are also 1 (0.3 s), 2 (0.4 s)."));
  EXPECT_THAT(error_of(path, "7"), HasSubstr("one of 0 (I, 0.2 s), 1 (0.3 s), 2 (0.4 s) in "));
}

TEST(SessionTest, ARigOfDevicesIsNamed) {
  SessionFile file(16384);
  stillhand_msgs::Event event;
  event.source("rig");
  event.text("rig of devices: force drive; simulated: platform");
  file.add(topics::kEvent, event);
  event.rig(event.rig() + 1);
  event.text("rig of devices: of another rig");
  file.add(topics::kEvent, event);
  file.control(0, PHASE_PEGGED, 0, 200);
  run_ticks(file, 0, 200);
  EXPECT_THAT(read_measurement(file_of(file.close())).notes,
              AllOf(Contains("The rig of devices: force drive; simulated: platform."),
                    Not(Contains(HasSubstr("of another rig")))));
}

TEST(SessionTest, ATrackingTrialHasTargetAndCursorToo) {
  const Measurement sut = read_measurement(file_of(session()), {"1"});
  EXPECT_EQ(sut.size(), 300u);
  ASSERT_EQ(sut.channels.size(), 9u);
  EXPECT_EQ(sut.channels[7].name, "x_r");
  EXPECT_EQ(sut.channels[8].name, "x_p");
  EXPECT_DOUBLE_EQ(sut.find("x_r")->values.front(), 8.0 * 0.4);
  EXPECT_DOUBLE_EQ(sut.find("x_p")->values.front(), 9.0 * 0.4);
}

// The force of stick and motor is no body's: a model of it would read the canceller's own filter.
TEST(SessionTest, TheForceOnAStickThatMovesIsUnsoundExceptNextToLateness) {
  ReadOptions options{"1"};
  EXPECT_THAT(diagnosis::why_unsound(read_measurement(file_of(session()), options), {"f"}),
              HasSubstr("the stick moves"));
  EXPECT_EQ(diagnosis::why_unsound(read_measurement(file_of(session()), {"0"}), {"f"}), "");
  options.lateness = true;
  EXPECT_EQ(diagnosis::why_unsound(read_measurement(file_of(session()), options), {"f"}), "");
}

TEST(SessionTest, ATrialIsKnownByNumberAndByTheLetterOfItsCondition) {
  const std::string path = file_of(session());
  EXPECT_EQ(read_measurement(path, {"A"}).size(), 400u);
  EXPECT_EQ(read_measurement(path, {"2"}).size(), 400u);
  EXPECT_EQ(read_measurement(path, {"I"}).size(), 200u);
}

TEST(SessionTest, AnUnknownTrialIsRefusedWithThoseThereAre) {
  const std::string path = file_of(session());
  EXPECT_THAT(error_of(path, "C"), HasSubstr("--trial: got C, want one of 0 (I, 0.2 s), "
                                             "1 (B, 0.3 s), 2 (A, 0.4 s)"));
  EXPECT_THAT(error_of(path, "01"), HasSubstr("--trial: got 01"));
}

TEST(SessionTest, AMitigatedTrialAndAFreeStickHaveNamesAndNoLetter) {
  SessionFile file;
  file.assignment(0, MOTION_BAND_NOISE, false);
  file.control(0, stillhand_msgs::PHASE_FREE, 0, 150);
  run_ticks(file, 0, 150);
  stillhand_msgs::TrialAssignment signal;
  signal.trial(1);
  signal.motion(MOTION_BAND_NOISE);
  signal.mitigation("signal");
  signal.parts().emplace_back().kind(stillhand_msgs::PART_SIGNAL);
  file.add(topics::kTrialAssignment, signal);
  file.control(1, PHASE_TRACKING, 200, 120);
  run_ticks(file, 150, 320);
  const std::string path = file_of(file.close());
  EXPECT_THAT(error_of(path, "B"), HasSubstr("0 (free, 0.15 s), 1 (signal, 0.12 s)"));
  EXPECT_EQ(read_measurement(path, {"signal"}).size(), 120u);
  EXPECT_EQ(read_measurement(path, {"free"}).size(), 150u);
}

TEST(SessionTest, ALetterThatTwoTrialsHaveIsNotEnough) {
  SessionFile file;
  for (int trial = 0; trial < 2; ++trial) {
    file.assignment(trial, MOTION_BAND_NOISE, true);
    file.control(trial, PHASE_TRACKING, 100 * trial, 100);
    run_ticks(file, 100 * trial, 100 * trial + 100);
  }
  const std::string path = file_of(file.close());
  EXPECT_THAT(error_of(path, "C"),
              HasSubstr("C, which matches several trials, want one of 0 (C, 0.1 s), 1"));
  EXPECT_EQ(read_measurement(path, {"1"}).size(), 100u);
  EXPECT_EQ(read_measurement(path, {.session_trial = "C"}).stretches[0].start_s, 0.1) << "the last";
  EXPECT_THAT(support::refusal([&] { (void)read_measurement(path, {.session_trial = "A"}); }),
              HasSubstr(path + ": got A, want one of 0 (C, 0.1 s), 1 (C, 0.1 s)"));
}

TEST(SessionTest, WithoutAnIdentificationTheLongestTrialIsTaken) {
  SessionFile file;
  file.control(4, PHASE_TRACKING, 0, 100);
  run_ticks(file, 0, 100);
  file.control(5, PHASE_TRACKING, 100, 180);
  run_ticks(file, 100, 200);
  file.control(5, PHASE_TRACKING, 100, 180);  // announced twice
  run_ticks(file, 200, 280);
  file.control(6, PHASE_TRACKING, 300, 120);
  run_ticks(file, 280, 420);
  EXPECT_EQ(read_measurement(file_of(file.close())).size(), 180u);
}

TEST(SessionTest, ATrialThatWasBrokenOffEndsThere) {
  SessionFile file;
  file.control(0, PHASE_PEGGED, 50, 500);
  run_ticks(file, 0, 200);
  file.control(-1);
  run_ticks(file, 200, 700);
  const Measurement sut = read_measurement(file_of(file.close()));
  EXPECT_EQ(sut.size(), 150u);
  EXPECT_THAT(sut.notes, Contains("The trial was ended early, after 150 of 500 ticks."));
}

TEST(SessionTest, TicksThatOneTopicLacksAreMissing) {
  SessionFile file;
  file.control(0, PHASE_TRACKING, 0, 200);
  for (int tick = 0; tick < 200; ++tick) {
    if (tick != 60) file.sensed(tick, tick == 90 ? Flag::kInputInvalid : Flag::kSaturated);
    if (tick != 120 && tick != 121) file.tracking(tick);
  }
  const Measurement sut = read_measurement(file_of(file.close()));
  ASSERT_EQ(sut.size(), 200u);
  for (std::size_t n = 0; n < 200; ++n) {
    const bool missing = n == 60 || n == 90 || n == 120 || n == 121;
    EXPECT_EQ(sut.weight[n], missing ? 0.0 : 1.0) << n;
    // Straight lines: the cubic gives them back.
    EXPECT_NEAR(sut.find("f")->values[n], 5e-3 * static_cast<double>(n), 1e-12);
    EXPECT_NEAR(sut.find("x_p")->values[n], 9e-3 * static_cast<double>(n), 1e-12);
  }
  EXPECT_THAT(sut.notes, Contains("1 sample without a valid reading: treated as missing."));
}

TEST(SessionTest, ATopicThatLacksMoreThanATenthOfTheTicksIsLeftOut) {
  for (const int there : {179, 180}) {
    SessionFile file;
    file.control(0, PHASE_TRACKING, 0, 202);
    stillhand_msgs::MotorCommand motor;
    for (int tick = 0; tick < 202; ++tick) {
      file.sensed(tick, tick == 5 || tick == 6 ? Flag::kFault : Flag::kSaturated);
      if (tick < there) file.tracking(tick);
      motor.tick(tick);
      motor.force_n(0.5 * tick);
      motor.gain_weight(0.25 * tick);
      if (tick < there) file.add(topics::kMotorCommand, motor);
    }
    const SessionRows sut = read_session_rows(file_of(file.close()), "0");
    const bool left_out = there == 179;
    EXPECT_EQ(sut.rows.row_count(), left_out ? 200u : 178u);
    EXPECT_EQ(sut.rows.columns.size(), left_out ? 7u : 10u);
    EXPECT_THAT(sut.notes, Contains(left_out ? HasSubstr("x_r and x_p left out")
                                             : HasSubstr("2 samples without a valid reading")));
    if (left_out) continue;
    EXPECT_EQ(sut.rows.find("f_motor")->values[177], 0.5 * 179.0);
    EXPECT_EQ(sut.weights[5], (std::array{0.25 * 7.0, 0.0}));
  }
}

TEST(SessionTest, ARecordingWithoutTrialsIsReadAsAWhole) {
  SessionFile file;
  run_ticks(file, 30, 130, false);
  const Measurement sut = read_measurement(file_of(file.close()));
  EXPECT_EQ(sut.size(), 100u);
  EXPECT_THAT(sut.notes, Contains("The recording announces no trial; it is read as a whole."));
}

TEST(SessionTest, SamplesOfAnotherRigAreLeftOut) {
  SessionFile file;
  for (int tick = 0; tick < 100; ++tick) {
    file.sensed(tick, 0, 3);
    file.sensed(tick + 1000, 0, 4);
  }
  const Measurement sut = read_measurement(file_of(file.close()));
  EXPECT_EQ(sut.size(), 100u);
  EXPECT_THAT(sut.notes, Contains("Rig 3; samples of other rigs are left out."));
}

TEST(SessionTest, SamplesDeliveredTwiceOrLateCountOnce) {
  SessionFile file;
  run_ticks(file, 0, 60, false);
  run_ticks(file, 40, 120, false);
  const Measurement sut = read_measurement(file_of(file.close()));
  EXPECT_EQ(sut.size(), 120u);
}

TEST(SessionTest, OfATruncatedFileTheReadablePartIsTaken) {
  auto bytes = session();
  bytes.resize(bytes.size() * 6 / 10);
  const Measurement sut = read_measurement(file_of(bytes));
  check(sut);
  EXPECT_EQ(sut.size(), 200u);  // the identification lies before the cut
  EXPECT_THAT(sut.notes, Contains(HasSubstr("Damaged file: ")));
}

TEST(SessionTest, AFileCutOffBeforeTheFirstSampleIsRefused) {
  auto bytes = session();
  for (const std::size_t size : {5u, 8u, 20u, 200u}) {
    bytes.resize(size);
    EXPECT_THAT(error_of(file_of(bytes)), HasSubstr("session")) << size;
  }
}

TEST(SessionTest, AnotherProgramsMcapIsRefusedWithAMappingThatWouldDo) {
  const auto bytes = tests::recorded_file(100, recording::Compression::kZstd, 1024);
  EXPECT_THAT(error_of(file_of(bytes)), HasSubstr("add --map 'even.x=a_y [m/s^2]' 'odd.x=f [N]'"));
}

TEST(SessionTest, TicksAndLengthsThatNoSessionHasAreNotBelieved) {
  SessionFile file;
  file.control(0, PHASE_PEGGED, std::numeric_limits<std::int64_t>::max() - 1, 100);
  file.control(2, PHASE_PEGGED, -1, 100);
  file.control(3, PHASE_PEGGED, 0, 0);
  file.control(1, PHASE_PEGGED, 10, std::numeric_limits<std::int64_t>::max());
  file.sensed(std::numeric_limits<std::int64_t>::max());
  file.sensed(-5);
  run_ticks(file, 0, 100, false);
  EXPECT_EQ(read_measurement(file_of(file.close())).size(), 100u);
}

// A hundred days; no ramp is shorter than none.
TEST(SessionTest, ATrialKeepsItsBoundsOnBothSides) {
  constexpr std::int64_t kMost = 8'640'000'000;
  const auto is_trial = [](std::int64_t start, std::int64_t duration, std::int64_t ramp) {
    SessionFile file;
    stillhand_msgs::TrialControl control;
    control.session(stillhand_msgs::SESSION_RUNNING);
    control.trial(0);
    control.phase(PHASE_TRACKING);
    control.start_tick(start);
    control.duration_ticks(duration);
    control.ramp_ticks(ramp);
    file.add(topics::kTrialControl, control);
    file.sensed(start);
    file.sensed(start + 1);
    const std::string path = file_of(file.close());
    recording::FileSource source(path);
    recording::McapReader reader(source);
    return find_trials(reader, path).trials.at(0).trial.number == 0;
  };
  for (const std::int64_t most : {kMost, kMost + 1}) {
    EXPECT_EQ(is_trial(0, most, 0), most == kMost);
    EXPECT_EQ(is_trial(0, 1, most), most == kMost);
  }
  EXPECT_TRUE(is_trial(kMost, 1, 0));
  EXPECT_FALSE(is_trial(0, 1, -1));
  EXPECT_FALSE(is_trial(0, 0, 0));
}

}  // namespace stillhand::measurement::session_test
