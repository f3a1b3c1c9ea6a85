// SPDX-License-Identifier: Apache-2.0
// Recordings in memory; the writers are those of a real participant, on a domain of the test's own.
#include "apps/replay/route_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "idl/idl_text.hpp"
#include "places.hpp"
#include "services/bus/recording/qos_texts.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "tests/support/memory_bytes.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::replay::route_plan_test {
namespace {

using recording::ChannelId;
using recording::TextMap;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr const char* kProfiles = STILLHAND_SOURCE "/qos/profiles.xml";

/// A recording that is made channel by channel and then planned.
class RoutePlanTest : public testing::Test {
 protected:
  /// A topic with the definition of idl/, unless the test gives another one.
  ChannelId channel(const std::string& topic, const std::string& type, TextMap metadata = {},
                    const std::string& encoding = "cdr", std::optional<std::string> idl = {}) {
    const std::string text = idl ? *idl : std::string(topics::idl_of(type));
    const auto schema = writer_.add_schema(type, "omgidl", text);
    const ChannelId id = writer_.add_channel(topic, schema, encoding, std::move(metadata));
    EXPECT_TRUE(writer_.write(id, 0, 1, 1, {}).ok());
    return id;
  }
  const recording::McapReader& reader() {
    EXPECT_TRUE(writer_.close().ok());
    source_.emplace(sink_.bytes());
    reader_.emplace(*source_);
    EXPECT_TRUE(reader_->status().ok());
    return *reader_;
  }
  RoutePlan plan() {
    runtime::Playback playback(kProfiles, support::own_domain(), "stillhand-replay/plan");
    return plan_routes(options_, reader(), playback);
  }
  std::string refusal_of_plan() {
    return support::refusal([&] { plan(); });
  }
  std::string refusal_of_names() {
    return support::refusal([&] { check_names(options_, reader()); });
  }

  recording::MemorySink sink_;
  recording::McapWriter writer_{sink_, {}};
  std::optional<recording::MemorySource> source_;
  std::optional<recording::McapReader> reader_;
  ReplayOptions options_;
};

TEST_F(RoutePlanTest, ARemapOfATopicThatIsNotRecordedNamesThoseThatAre) {
  channel("stillhand/sensed", "stillhand_msgs::Sensed");
  options_.remap = {{"stillhand/sense", "x"}};
  EXPECT_THAT(refusal_of_names(), AllOf(StartsWith("--remap: "), HasSubstr("stillhand/sense,"),
                                        HasSubstr("stillhand/sensed")));
}

TEST_F(RoutePlanTest, ARemapOfATopicThatIsBlockedIsRefused) {
  channel("stillhand/sensed", "stillhand_msgs::Sensed");
  options_.topics.block = {"*sensed"};
  options_.remap = {{"stillhand/sensed", "x"}};
  EXPECT_THAT(refusal_of_names(), AllOf(StartsWith("--remap: "), HasSubstr("--block")));
}

TEST_F(RoutePlanTest, ARemapOfATopicThatIsPlayedIsTaken) {
  channel("stillhand/sensed", "stillhand_msgs::Sensed");
  options_.remap = {{"stillhand/sensed", "x"}};
  EXPECT_EQ(refusal_of_names(), "accepted");
}

TEST_F(RoutePlanTest, EachWantedChannelHasAWriterUnderItsOwnOrItsNewName) {
  const ChannelId sensed = channel("stillhand/sensed", "stillhand_msgs::Sensed");
  channel("stillhand/event", "stillhand_msgs::Event");
  const ChannelId motor = channel("stillhand/motor_command", "stillhand_msgs::MotorCommand");
  options_.topics.block = {"*event"};
  options_.remap = {{"stillhand/sensed", "bench/sensed"}};
  const RoutePlan sut = plan();
  EXPECT_THAT(sut.wanted, ElementsAre(sensed, motor));
  EXPECT_EQ(sut.routes.at(sensed).topic, "bench/sensed");
  EXPECT_EQ(sut.routes.at(motor).topic, "stillhand/motor_command");
  EXPECT_NE(sut.routes.at(sensed).writer, sut.routes.at(motor).writer);
  EXPECT_THAT(sut.latched, IsEmpty());
}

// The recorded QoS decides; without it the profile that the channel names; without that the
// catalogue's row.
TEST_F(RoutePlanTest, AStateIsLatchedByItsQosItsProfileOrItsRowInTheCatalogue) {
  runtime::WriterQos latched;
  latched.reliable = true;
  latched.durability = runtime::Durability::kTransientLocal;
  latched.depth = 1;
  runtime::WriterQos deeper = latched;
  deeper.depth = 2;
  const std::string type = "stillhand_msgs::TrialControl";
  const ChannelId by_qos = channel("a", type, recording::qos_texts(latched));
  channel("b", type, recording::qos_texts(deeper));
  const ChannelId by_profile = channel("c", type, {{"qos_profile", "state_latched"}});
  channel("d", type, {{"qos_profile", "event"}});
  const ChannelId by_row = channel("stillhand/trial_control", type);
  channel("e", type);
  channel("f", type, {{"qos_profile", "no_such_profile"}});
  const RoutePlan sut = plan();
  EXPECT_EQ(sut.wanted.size(), 7u);
  EXPECT_THAT(sut.latched, ElementsAre(by_qos, by_profile, by_row));
}

TEST_F(RoutePlanTest, TheRecordedQosCountsBeforeTheCatalogue) {
  channel("stillhand/trial_control", "stillhand_msgs::TrialControl",
          recording::qos_texts(runtime::WriterQos{}));
  EXPECT_THAT(plan().latched, IsEmpty());
}

TEST_F(RoutePlanTest, AChannelThatCannotBePlayedLeavesTheOthers) {
  channel("json", "stillhand_msgs::Sensed", {}, "json");
  channel("stranger", "other::Type", {}, "cdr", "struct Type { long x; };");  // without its QoS
  const ChannelId sensed = channel("stillhand/sensed", "stillhand_msgs::Sensed");
  testing::internal::CaptureStderr();
  const RoutePlan sut = plan();
  const std::string printed = testing::internal::GetCapturedStderr();
  EXPECT_THAT(sut.wanted, ElementsAre(sensed));
  EXPECT_THAT(printed, AllOf(HasSubstr("json: "), HasSubstr("\"json\""), HasSubstr("CDR"),
                             HasSubstr("stranger: "), HasSubstr("other::Type")));
}

TEST_F(RoutePlanTest, AForeignTypeIsPlayedAsBytesButUnderNoNameOfTheCatalogue) {
  const TextMap qos = recording::qos_texts(runtime::WriterQos{});
  const ChannelId known = channel("plant/state", "plant::State", qos, "cdr", "not even IDL");
  const ChannelId sensed = channel("stillhand/sensed", "stillhand_msgs::Sensed");
  channel("stillhand/motor_command", "plant::State", qos, "cdr", "");
  channel("plant/push", "plant::State", qos, "cdr", "");
  options_.remap = {{"plant/push", "stillhand/motor_command"}};
  testing::internal::CaptureStderr();
  const RoutePlan sut = plan();
  const std::string printed = testing::internal::GetCapturedStderr();
  EXPECT_THAT(sut.wanted, ElementsAre(known, sensed));
  EXPECT_TRUE(sut.routes.at(known).foreign);
  EXPECT_FALSE(sut.routes.at(sensed).foreign);
  EXPECT_THAT(printed, AllOf(HasSubstr("stillhand/motor_command: "), HasSubstr("plant/push: ")));
}

TEST_F(RoutePlanTest, AnotherDefinitionOfATypeIsRefusedWithTheDifference) {
  std::string idl(topics::idl_of("stillhand_msgs::Sensed"));
  const std::size_t field = idl.find("double force_n", idl.find("struct Sensed {"));
  ASSERT_NE(field, std::string::npos);
  idl.replace(field, 6, "float ");
  channel("stillhand/sensed", "stillhand_msgs::Sensed", {}, "cdr", idl);
  EXPECT_THAT(refusal_of_plan(), AllOf(HasSubstr("stillhand_msgs::Sensed"), HasSubstr("force_n")));
}

TEST_F(RoutePlanTest, ADefinitionThatIsNoIdlIsRefused) {
  channel("stillhand/sensed", "stillhand_msgs::Sensed", {}, "cdr", "struct {{{");
  EXPECT_THAT(refusal_of_plan(), HasSubstr("stillhand/sensed: "));
}

TEST_F(RoutePlanTest, PatternsThatSelectNoTopicAreRefusedWithTheTopicsThereAre) {
  channel("stillhand/sensed", "stillhand_msgs::Sensed");
  options_.topics.allow = {"stillhand/sense"};
  EXPECT_THAT(refusal_of_plan(),
              AllOf(StartsWith("--topics and --block: "), HasSubstr("stillhand/sensed")));
}

}  // namespace
}  // namespace stillhand::replay::route_plan_test
