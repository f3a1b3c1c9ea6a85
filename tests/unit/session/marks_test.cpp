// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/marks.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace stillhand::session::marks_test {
namespace {

using namespace stillhand_msgs;

Event event_of(EventKind kind, const char* source, const char* topic, const char* peer,
               double by_us) {
  Event event;
  event.kind(kind);
  event.source(source);
  event.topic(topic);
  event.peer(peer);
  event.by_us(by_us);
  event.text("late");
  event.tick(4711);
  return event;
}

TEST(MarkTest, EveryKindOfEventHasANameOfItsOwn) {
  std::set<std::string> names;
  for (std::uint32_t kind = 0; kind <= static_cast<std::uint32_t>(EVENT_SECOND_WRITER); ++kind) {
    names.insert(mark_of(event_of(static_cast<EventKind>(kind), "rig", "", "", 0.0)).what);
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(EVENT_SECOND_WRITER) + 1);
  EXPECT_FALSE(names.contains("event"));
  EXPECT_EQ(mark_of(event_of(static_cast<EventKind>(1000), "rig", "", "", 0.0)).what, "event");
}

TEST(MarkTest, HoldsTheFieldsOfItsEvent) {
  const Mark sut = mark_of(event_of(EVENT_TICKS_LOST, "sensing", "stillhand/raw", "rig", 3.0));
  EXPECT_EQ(sut.source, "sensing");
  EXPECT_EQ(sut.topic, "stillhand/raw");
  EXPECT_EQ(sut.peer, "rig");
  EXPECT_EQ(sut.text, "late");
  EXPECT_EQ(sut.first_tick, 4711);
  EXPECT_EQ(sut.count, 1);
  EXPECT_EQ(sut.worst_us, 3.0);
}

TEST(MarkTest, EqualEventsAreOneMarkWithTheFirstsTickAndTheWorstSize) {
  std::vector<Mark> sut;
  for (const double late_us : {200.0, 900.0, 100.0}) {
    Event event = event_of(EVENT_CYCLE_MISSED, "rig", "stillhand/raw", "", late_us);
    event.tick(static_cast<std::int64_t>(late_us));
    event.text(std::to_string(late_us).c_str());
    add_mark(sut, mark_of(event));
  }
  ASSERT_EQ(sut.size(), 1u);
  EXPECT_EQ(sut[0].count, 3);
  EXPECT_EQ(sut[0].worst_us, 900.0);
  EXPECT_EQ(sut[0].first_tick, 200);
  EXPECT_EQ(sut[0].text, std::to_string(200.0));
}

TEST(MarkTest, AnotherKindProcessTopicOrPeerIsAnotherMark) {
  std::vector<Mark> sut;
  add_mark(sut, mark_of(event_of(EVENT_CYCLE_MISSED, "rig", "raw", "motion", 1.0)));
  add_mark(sut, mark_of(event_of(EVENT_DEADLINE_MISSED, "rig", "raw", "motion", 1.0)));
  add_mark(sut, mark_of(event_of(EVENT_CYCLE_MISSED, "display", "raw", "motion", 1.0)));
  add_mark(sut, mark_of(event_of(EVENT_CYCLE_MISSED, "rig", "sensed", "motion", 1.0)));
  add_mark(sut, mark_of(event_of(EVENT_CYCLE_MISSED, "rig", "raw", "", 1.0)));
  ASSERT_EQ(sut.size(), 5u);
  add_mark(sut, sut[3]);
  EXPECT_EQ(sut.size(), 5u);
  EXPECT_EQ(sut[3].count, 2);
  EXPECT_EQ(sut[0].count, 1);
}

TEST(MarkTest, ALineHasOnlyThePartsThatThereAre) {
  Mark mark{"deadline missed", "rig", "", "", "", 0, 1, 0.0};
  EXPECT_EQ(line_of(mark), "rig: deadline missed");
  mark.text = "7 ms";
  EXPECT_EQ(line_of(mark), "rig: deadline missed (7 ms)");
  mark.topic = "stillhand/sensed";
  mark.peer = "motion";
  EXPECT_EQ(line_of(mark), "rig: deadline missed on stillhand/sensed of motion (7 ms)");
}

TEST(MarkTest, AModelThatNoLongerHoldsSaysSinceWhen) {
  stillhand_msgs::Event event;
  event.kind(stillhand_msgs::EVENT_NOTE);
  event.code(stillhand_msgs::CODE_MODEL_CHANGED);
  event.source("identification");
  event.tick(127'000);
  event.by_us(28e6);
  event.text("by 26 % of the predicted force");
  const Trial trial{.number = 1, .phase = TrialPhase::kTracking, .start_tick = 23'000};
  EXPECT_EQ(model_change(mark_of(event), trial),
            "the model no longer holds since 76 s of trial 1, by 26 % of the predicted force; "
            "noticed at 104 s");
  EXPECT_NEAR(model_lost_s(mark_of(event), trial).value(), 76.0, 1e-9);
  event.code(stillhand_msgs::CODE_NONE);
  EXPECT_EQ(model_change(mark_of(event), trial), "");
  EXPECT_FALSE(model_lost_s(mark_of(event), trial));
}

}  // namespace
}  // namespace stillhand::session::marks_test
