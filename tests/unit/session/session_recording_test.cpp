// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/session_recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/folder.hpp"
#include "tests/support/recorded_file.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/session/recorded_session.hpp"

namespace stillhand::session::session_recording_test {
namespace {

using made::file_of;
using made::Tape;
using testing::HasSubstr;

std::string name_of(const topics::Topic& topic) { return std::string(topic.name); }

TEST(SessionRecordingTest, EveryMessageIsInTheListOfItsTopicInOrder) {
  Tape tape;
  tape.file.control(3, stillhand_msgs::PHASE_TRACKING, 10, 20);
  tape.file.assignment(3, stillhand_msgs::MOTION_ROAD, true);
  for (Tick tick = 10; tick < 30; ++tick) {
    tape.file.sensed(tick);
    tape.tracking(tick, 0.001 * static_cast<double>(tick), 0.0);
  }
  const SessionRecording sut = read_session(tape.close());
  ASSERT_EQ(sut.sensed.size(), 20u);
  ASSERT_EQ(sut.tracking_samples.size(), 20u);
  EXPECT_EQ(sut.sensed.back().tick(), 29);
  EXPECT_EQ(sut.sensed.back().accel_y_m_s2(), 2.0 * 0.029);
  EXPECT_EQ(sut.tracking_samples[5].target_m(), 0.001 * 15.0);
  ASSERT_EQ(sut.trial_controls.size(), 1u);
  EXPECT_EQ(sut.trial_controls[0].duration_ticks(), 20);
  ASSERT_EQ(sut.trial_assignments.size(), 1u);
  EXPECT_TRUE(sut.trial_assignments[0].cancellation());
  EXPECT_EQ(sut.messages.at(name_of(topics::kSensed)), 20);
  EXPECT_FALSE(sut.messages.contains(name_of(topics::kMotorCommand)));
  EXPECT_TRUE(sut.damage.empty());
}

// The recorder keeps what anybody writes.
TEST(SessionRecordingTest, WhatAStrangerWroteIsNotTheSessions) {
  const std::string own = "01.0f.01.02.03.04.05.06.00.00.00.0a";
  const std::string stranger = "01.0f.01.02.03.04.05.06.00.00.00.0b";
  Tape tape;
  tape.file.written_by(own + "|0.0.1.3");
  stillhand_msgs::SessionSources message;
  for (const std::string_view service : topics::kServices) {
    auto& source = message.sources().emplace_back();
    source.service(std::string(service));
    source.participant("010f0102030405060000000a");
  }
  tape.file.add(topics::kSessionSources, message);
  for (Tick tick = 0; tick < 10; ++tick) {
    tape.file.written_by(own + "|0.0.2.3");
    tape.file.sensed(tick);
    tape.file.written_by(stranger + "|0.0.2.3");
    tape.file.sensed(1000 + tick);
  }
  // Nor is a list of sources of which its writer is not the experiment.
  for (auto& source : message.sources()) source.participant("010f01020304050600000000");
  tape.file.add(topics::kSessionSources, message);
  tape.file.control(3, stillhand_msgs::PHASE_TRACKING, 10, 20);
  tape.file.written_by(own + "|0.0.2.3");
  tape.file.sensed(10);
  const SessionRecording sut = read_session(tape.close());
  ASSERT_EQ(sut.sensed.size(), 11u);
  EXPECT_EQ(sut.sensed.back().tick(), 10);
  EXPECT_EQ(sut.lost_ticks.at(name_of(topics::kSensed)), 0);
  EXPECT_TRUE(sut.trial_controls.empty());
}

TEST(SessionRecordingTest, EveryTickThatIsMissingIsLostAndOneThatComesTwiceIsNot) {
  Tape tape;
  for (const Tick tick : {100, 101, 101, 104, 105, 105, 115}) tape.file.sensed(tick);
  tape.tracking(7, 0.0, 0.0);
  const auto sut = read_session(tape.close()).lost_ticks;
  EXPECT_EQ(sut.at(name_of(topics::kSensed)), 2 + 9);
  EXPECT_EQ(sut.at(name_of(topics::kTrackingSample)), 0);
  EXPECT_EQ(sut.at(name_of(topics::kRigTruth)), 0);
  EXPECT_EQ(sut.size(), 7u);  // the streams of 1 kHz
}

TEST(SessionRecordingTest, AMessageThatIsNotOfItsTypeIsDamageAndTheOthersAreRead) {
  Tape tape;
  tape.file.sensed(1);
  // One boolean where a sample of 1 kHz is expected.
  tape.file.add(topics::kMotorCommand, stillhand_msgs::ValueMap{});
  tape.file.sensed(2);
  const SessionRecording sut = read_session(tape.close());
  EXPECT_EQ(sut.sensed.size(), 2u);
  EXPECT_TRUE(sut.motor_commands.empty());
  ASSERT_EQ(sut.damage.size(), 1u);
  EXPECT_THAT(sut.damage[0], HasSubstr(name_of(topics::kMotorCommand)));
  EXPECT_FALSE(sut.messages.contains(name_of(topics::kMotorCommand)));
}

// Questions and answers of the clocks are only counted, but they too are looked at.
TEST(SessionRecordingTest, AMessageWithoutAListIsCountedOrReportedAsDamage) {
  Tape tape;
  tape.file.add(topics::kClockQuestion, stillhand_msgs::ClockQuestion{});
  tape.file.add(topics::kClockQuestion, stillhand_msgs::ClockQuestion{});
  tape.file.add(topics::kHostStatus, stillhand_msgs::ValueMap{});
  const SessionRecording sut = read_session(tape.close());
  EXPECT_EQ(sut.messages.at(name_of(topics::kClockQuestion)), 2);
  ASSERT_EQ(sut.damage.size(), 1u);
  EXPECT_THAT(sut.damage[0], HasSubstr(name_of(topics::kHostStatus)));
}

TEST(SessionRecordingTest, ATopicOfAnotherProgramIsPassedOver) {
  const auto bytes = tests::recorded_file(20, recording::Compression::kZstd, 1024);
  const SessionRecording sut = read_session(file_of(bytes));
  EXPECT_TRUE(sut.messages.empty());
  EXPECT_TRUE(sut.damage.empty());
}

TEST(SessionRecordingTest, AFileThatWasCutOffKeepsWhatCameBefore) {
  tests::SessionFile file(512, recording::Compression::kNone);
  for (Tick tick = 0; tick < 200; ++tick) file.sensed(tick);
  auto bytes = file.close();
  bytes.resize(bytes.size() / 2);
  const SessionRecording sut = read_session(file_of(bytes));
  EXPECT_GT(sut.sensed.size(), 20u);
  EXPECT_LT(sut.sensed.size(), 200u);
  EXPECT_FALSE(sut.damage.empty());
  EXPECT_EQ(sut.lost_ticks.at(name_of(topics::kSensed)), 0);
}

TEST(SessionRecordingTest, AFileThatIsNoRecordingIsRefusedByName) {
  for (const std::string& content :
       {std::string(), std::string("t [s],f [N]\n0,1\n"), std::string(5000, '\0')}) {
    std::vector<std::byte> bytes;
    for (const char c : content) bytes.push_back(static_cast<std::byte>(c));
    const std::string path = file_of(bytes);
    EXPECT_THAT(support::refusal([&] { read_session(path); }), testing::StartsWith(path + ": got "))
        << content.size() << " bytes";
  }
}

TEST(SessionRecordingTest, AMissingFileIsRefusedByName) {
  const std::string path = support::Folder() / "no_such_session.mcap";
  EXPECT_THAT(support::refusal<std::exception>([&] { read_session(path); }), HasSubstr(path));
}

}  // namespace
}  // namespace stillhand::session::session_recording_test
