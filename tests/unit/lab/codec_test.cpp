// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/codec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/messages/cancellation/codec.hpp"

namespace stillhand::lab::codec_test {
namespace {

stillhand_msgs::TopicStatus topic(bool written, std::uint64_t deadline, std::uint64_t cycle,
                                  std::uint64_t lost) {
  stillhand_msgs::TopicStatus status;
  status.written(written);
  status.deadline_misses(deadline);
  status.cycle_misses(cycle);
  status.lost_ticks(lost);
  return status;
}

TEST(LabCodecTest, AStatusCountsTheMissesOfTheTopicsThatAreRead) {
  stillhand_msgs::ServiceStatus status;
  status.state(stillhand_msgs::SERVICE_STARTING);
  status.missing("rig (stillhand/event)");
  status.tick(17);
  status.armed_trial(3);
  status.topics({topic(false, 1, 2, 3), topic(true, 100, 100, 100), topic(false, 10, 20, 30)});
  const ProcessSeen seen = from_idl(status);
  EXPECT_FALSE(seen.matched);
  EXPECT_EQ(seen.missing, "rig (stillhand/event)");
  EXPECT_EQ(seen.tick, 17);
  EXPECT_EQ(seen.armed_trial, 3);
  EXPECT_EQ(seen.misses.deadline, 11);
  EXPECT_EQ(seen.misses.cycle, 22);
  EXPECT_EQ(seen.misses.lost_ticks, 33);
  status.state(stillhand_msgs::SERVICE_READY);
  EXPECT_TRUE(from_idl(status).matched);
}

TEST(LabCodecTest, AnEventBecomesTheSameMarkAndLineAsInARecording) {
  stillhand_msgs::Event event;
  event.kind(stillhand_msgs::EVENT_INTERLOCK_OPENED);
  event.source("rig");
  event.topic("stillhand/service_status");
  event.peer("motion");
  event.text("its life sign is gone");
  event.tick(5000);
  event.by_us(12.5);
  const EventSeen seen = from_idl(event);
  EXPECT_EQ(seen.kind, EventKind::kInterlockOpened);
  const session::Mark mark = mark_of(seen);
  const session::Mark want = session::mark_of(event);
  EXPECT_EQ(seen.line, session::line_of(want));
  EXPECT_EQ(session::line_of(mark), session::line_of(want));
  EXPECT_EQ(mark.first_tick, 5000);
  EXPECT_EQ(mark.count, 1);
  EXPECT_EQ(mark.worst_us, 12.5);
}

TEST(LabCodecTest, EveryFieldOfAPromptIsSetAndItsWaitBecomesATick) {
  const Prompt prompt{.kind = PromptKind::kQuestion,
                      .participant = "P07",
                      .block = 1,
                      .blocks = 2,
                      .trial = 4,
                      .trials = 12,
                      .wait_s = 1.5,
                      .text = "How hard?\n",
                      .lowest = "not",
                      .highest = "very",
                      .steps = 7};
  const stillhand_msgs::Prompt message = to_idl(prompt, 9, 20'000);
  EXPECT_EQ(message.number(), 9u);
  EXPECT_EQ(message.kind(), stillhand_msgs::PROMPT_QUESTION);
  EXPECT_STREQ(message.participant().c_str(), "P07");
  EXPECT_EQ(message.block(), 1);
  EXPECT_EQ(message.blocks(), 2);
  EXPECT_EQ(message.trial(), 4);
  EXPECT_EQ(message.trials(), 12);
  EXPECT_EQ(message.end_tick(), 21'500);
  EXPECT_STREQ(message.text().c_str(), "How hard?\n");
  EXPECT_STREQ(message.lowest().c_str(), "not");
  EXPECT_STREQ(message.highest().c_str(), "very");
  EXPECT_EQ(message.steps(), 7);
  EXPECT_EQ(to_idl(prompt, 9, -1).end_tick(), -1);
  EXPECT_EQ(to_idl({}, 1, 20'000).end_tick(), -1);
}

TEST(LabCodecTest, AnAnswerNamesItsPrompt) {
  stillhand_msgs::Answer message;
  message.prompt_number(9);
  message.value(-3);
  EXPECT_EQ(from_idl(message).prompt, 9u);
  EXPECT_EQ(from_idl(message).value, -3);
}

TEST(LabCodecTest, AnActionOfAnotherVersionIsUnknown) {
  constexpr runtime::ParticipantId sender{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  stillhand_msgs::SessionCommand command;
  command.action(static_cast<stillhand_msgs::SessionAction>(99));
  command.request(7);
  command.asker("desk");
  EXPECT_EQ(from_idl(command, sender).action, Action::kUnknown);
  command.action(stillhand_msgs::SESSION_STOP);
  EXPECT_EQ(from_idl(command, sender).action, Action::kStop);
  EXPECT_EQ(from_idl(command, sender).request, 7u);
  EXPECT_EQ(from_idl(command, sender).asker, "desk");
  EXPECT_EQ(from_idl(command, sender).sender, "0102030405060708090a0b0c");
}

TEST(LabCodecTest, AnAnnouncementWithoutATrialIsIdle) {
  const auto idle = to_idl({SessionState::kPaused, std::nullopt}, 9);
  EXPECT_EQ(idle.session(), stillhand_msgs::SESSION_PAUSED);
  EXPECT_EQ(idle.trial(), -1);
  EXPECT_EQ(idle.phase(), stillhand_msgs::PHASE_IDLE);
  EXPECT_EQ(idle.reference_seed(), 0u);
}

TEST(LabCodecTest, AnAnnouncementOfATrialHasItsTicksAndTheSeedOfItsTarget) {
  const Trial trial{4, TrialPhase::kPegged, 3100, 5000, 2000};
  const auto message = to_idl({SessionState::kRunning, trial}, 9);
  EXPECT_EQ(message.session(), stillhand_msgs::SESSION_RUNNING);
  EXPECT_EQ(message.trial(), 4);
  EXPECT_EQ(message.phase(), stillhand_msgs::PHASE_PEGGED);
  EXPECT_EQ(message.start_tick(), 3100);
  EXPECT_EQ(message.duration_ticks(), 5000);
  EXPECT_EQ(message.ramp_ticks(), 2000);
  EXPECT_EQ(message.reference_seed(), 9u);
}

TEST(LabCodecTest, TheAssignmentHoldsTheBlindedPart) {
  session::PlannedTrial planned{};
  planned.trial.number = 4;
  planned.motion = motion::MotionKind::kRoad;
  planned.cancellation = true;
  planned.motion_seed = 5;
  EXPECT_EQ(assignment_of(planned).motion(), stillhand_msgs::MOTION_STILL);
  planned.moving = true;
  const auto message = assignment_of(planned);
  EXPECT_EQ(message.trial(), 4);
  EXPECT_EQ(message.motion(), stillhand_msgs::MOTION_ROAD);
  EXPECT_EQ(message.motion_seed(), 5u);
  EXPECT_TRUE(message.cancellation());
}

TEST(LabCodecTest, PartsOfAnAssignmentComeBackAsTheyWereSent) {
  session::PlannedTrial planned{};
  planned.label = session::Condition::kDampingForce;
  planned.parts = {{cancellation::PartKind::kForce, {}},
                   {cancellation::PartKind::kImpedance, {1.5, 2.5, 3.5}}};
  const auto message = assignment_of(planned);
  EXPECT_STREQ(message.mitigation().c_str(), "damping+force");
  EXPECT_FALSE(message.cancellation());
  EXPECT_EQ(cancellation::parts_of(message), planned.parts);
  EXPECT_TRUE(cancellation::from_idl(message).parts);
  planned.parts.clear();
  EXPECT_STREQ(assignment_of(planned).mitigation().c_str(), "");
  EXPECT_FALSE(cancellation::from_idl(assignment_of(planned)).parts);
}

}  // namespace
}  // namespace stillhand::lab::codec_test
