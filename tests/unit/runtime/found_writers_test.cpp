// SPDX-License-Identifier: Apache-2.0
#include "services/bus/found_writers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "idl/idl_text.hpp"
#include "tests/unit/runtime/announced.hpp"

namespace stillhand::runtime::found_writers_test {
namespace {

using announced::gone;
using announced::handle_of;
using announced::participant;
using announced::prefix_of;
using announced::writer;

AnnouncedWriter sensed(std::uint8_t participant, std::uint8_t number = 1) {
  return announced::writer(participant, number, "stillhand/sensed", "stillhand_msgs::Sensed");
}

TEST(FoundWritersTest, WritersAreNumberedInTheOrderOfDiscoveryAndKeepTheirNumber) {
  FoundWriters sut;
  EXPECT_EQ(sut.note_writer(sensed(7)), 0u);
  EXPECT_EQ(sut.note_writer(sensed(3)), 1u);
  EXPECT_EQ(sut.note_writer(sensed(7, 2)), 2u);
  EXPECT_EQ(sut.note_writer(sensed(7)), std::nullopt);  // known
  EXPECT_EQ(sut.all().size(), 3u);
  EXPECT_EQ(sut.find(handle_of(3)), 1u);
  EXPECT_EQ(sut.find(handle_of(7, 2)), 2u);
  EXPECT_EQ(sut.find(handle_of(7, 3)), std::nullopt);
}

TEST(FoundWritersTest, AWriterIsDescribedAsItWasAnnounced) {
  FoundWriters sut;
  auto reliable = writer(7, 1, "stillhand/sensed", "stillhand_msgs::Sensed", replay_mark());
  reliable.qos.m_reliability.kind = edds::RELIABLE_RELIABILITY_QOS;
  sut.note_writer(reliable, false);
  const FoundWriter found = sut.at(0);
  EXPECT_EQ(found.topic, "stillhand/sensed");
  EXPECT_EQ(found.type, "stillhand_msgs::Sensed");
  EXPECT_EQ(found.profile, "stream_1khz");
  EXPECT_TRUE(found.type_known);
  EXPECT_TRUE(found.replayed);
  EXPECT_TRUE(found.present);
  EXPECT_FALSE(found.wanted);
  EXPECT_TRUE(found.qos.reliable);
  EXPECT_EQ(found.qos.depth, 0);  // discovery does not carry it
}

TEST(FoundWritersTest, AStrangersTopicHasNoProfileAndItsTypeIsNotKnown) {
  FoundWriters sut;
  sut.note_writer(writer(7, 1, "chatter", "std_msgs::String", {1, 2, 3}));
  EXPECT_EQ(sut.at(0).profile, "");
  EXPECT_FALSE(sut.at(0).type_known);
  EXPECT_EQ(sut.at(0).idl, "");
  EXPECT_EQ(sut.at(0).user_data, "");  // no text
  EXPECT_TRUE(sut.at(0).qos.keyed);
  EXPECT_FALSE(sut.at(0).replayed);
  EXPECT_TRUE(sut.at(0).wanted);
}

TEST(FoundWritersTest, TheDefinitionThatDiscoveryGivesIsKeptExceptOfOurOwnTypes) {
  FoundWriters sut;
  AnnouncedWriter stranger = writer(7, 1, "chatter", "std_msgs::String", {'h', '=', '1'});
  stranger.idl = "a definition";
  stranger.guid.entityId.value[3] = 0x03;  // without a key
  stranger.qos.representation.m_value = {edds::XCDR2_DATA_REPRESENTATION,
                                         edds::XCDR_DATA_REPRESENTATION};
  sut.note_writer(stranger);
  AnnouncedWriter ours = sensed(8);
  ours.idl = "another definition";
  sut.note_writer(ours);
  EXPECT_EQ(sut.at(0).idl, "a definition");
  EXPECT_EQ(sut.at(0).user_data, "h=1");
  EXPECT_FALSE(sut.at(0).qos.keyed);
  EXPECT_TRUE(sut.at(0).qos.xcdr2);
  EXPECT_EQ(sut.at(1).idl, topics::idl_of("stillhand_msgs::Sensed"));
  EXPECT_FALSE(sut.at(1).qos.xcdr2);
}

TEST(FoundWritersTest, DefinitionsWithoutAnEndFillNoMemory) {
  FoundWriters sut;
  const std::size_t each = FoundWriters::kMostIdlBytes / 4;
  for (std::uint8_t number = 0; number < 6; ++number) {
    AnnouncedWriter stranger = writer(7, number, "chatter", "std_msgs::String");
    stranger.idl = std::string(each, static_cast<char>('a' + number));
    sut.note_writer(stranger);
    EXPECT_EQ(sut.at(number).idl.size(), number < 4 ? each : 0) << int{number};
  }
}

TEST(AnnouncedTest, ADescriptionIsReadUpToItsBounds) {
  EXPECT_TRUE(is_bounded(std::vector<std::uint32_t>{64 * 1024}));
  EXPECT_FALSE(is_bounded(std::vector<std::uint32_t>{64 * 1024, 1}));
  EXPECT_FALSE(is_bounded(std::vector<std::uint32_t>(3, UINT32_MAX)));
  EXPECT_TRUE(is_bounded(std::vector<std::uint32_t>(1 + 256, 100)));
  EXPECT_FALSE(is_bounded(std::vector<std::uint32_t>(1 + 257, 100)));
}

// Each comes with a writer of its own, and leaves.
TEST(FoundWritersTest, StrangersThatComeAndGoFillNoMemoryAndTakeNobodysPlace) {
  FoundWriters sut;
  sut.note_writer(sensed(9));
  sut.find(handle_of(9));  // a sample came
  sut.note_writer(gone(sensed(9)));
  AnnouncedWriter stranger = writer(7, 1, "chatter", "std_msgs::String");
  for (std::uint32_t i = 0; i < FoundWriters::kMost + 100; ++i) {
    stranger.guid = {prefix_of(7), i << 8 | 0x02};
    ASSERT_NE(sut.note_writer(stranger), std::nullopt) << i;
    sut.note_writer(gone(stranger));
  }
  EXPECT_EQ(sut.all().size(), FoundWriters::kMost);
  EXPECT_EQ(sut.find(handle_of(9)), 0u);
}

TEST(FoundWritersTest, EveryWriterHasAnIdOfItsOwn) {
  FoundWriters sut;
  std::set<std::string> ids;
  for (std::uint8_t participant = 1; participant <= 20; ++participant) {
    for (std::uint8_t number = 1; number <= 3; ++number) {
      sut.note_writer(sensed(participant, number));
    }
  }
  for (const FoundWriter& writer : sut.all()) ids.insert(writer.id);
  EXPECT_EQ(ids.size(), 60u);
}

// DDS announces the two in either order.
TEST(FoundWritersTest, TheParticipantsNameReachesItsWritersBeforeAndAfterThem) {
  FoundWriters sut;
  sut.note_writer(sensed(7));
  sut.note_writer(sensed(8));
  EXPECT_EQ(sut.at(0).participant, "");
  sut.note_participant(participant(7, "stillhand/1/sensing"));
  EXPECT_EQ(sut.at(0).participant, "stillhand/1/sensing");
  EXPECT_EQ(sut.at(1).participant, "");
  sut.note_writer(sensed(7, 2));
  EXPECT_EQ(sut.at(2).participant, "stillhand/1/sensing");
  sut.note_participant(prefix_of(8), "renamed");
  EXPECT_EQ(sut.at(1).participant, "renamed");
}

TEST(FoundWritersTest, AWriterThatLeftStaysWithItsNumberAndIsNotPresent) {
  FoundWriters sut;
  sut.note_writer(sensed(7));
  sut.note_writer(sensed(8));
  EXPECT_EQ(sut.note_writer(gone(sensed(7))), std::nullopt);
  EXPECT_FALSE(sut.at(0).present);
  EXPECT_TRUE(sut.at(1).present);
  EXPECT_EQ(sut.find(handle_of(7)), 0u);
  EXPECT_EQ(sut.note_writer(gone(sensed(9))), std::nullopt);
  EXPECT_EQ(sut.all().size(), 2u);  // the end of a writer that was never found adds none
}

TEST(FoundWritersTest, AParticipantThatLeavesTakesItsWritersAlong) {
  FoundWriters sut;
  sut.note_writer(sensed(7, 1));
  sut.note_writer(sensed(7, 2));
  sut.note_writer(sensed(8));
  sut.note_participant(gone(participant(7, "")));
  EXPECT_FALSE(sut.at(0).present);
  EXPECT_FALSE(sut.at(1).present);
  EXPECT_TRUE(sut.at(2).present);
}

TEST(FoundWritersTest, ANumberThatWasNotGivenIsRefused) {
  const FoundWriters sut;
  EXPECT_THROW(static_cast<void>(sut.at(0)), std::out_of_range);
}

TEST(SampleWritersTest, AnEntryIsTheWriterOfTheSampleAndStaysWhereItIs) {
  FoundWriters all;
  SampleWriters sut(all);
  EXPECT_EQ(sut.of(handle_of(7)), nullptr);
  all.note_writer(sensed(7));
  all.note_writer(sensed(8));
  const SampleWriters::Entry* seven = sut.of(handle_of(7));
  ASSERT_NE(seven, nullptr);
  EXPECT_EQ(seven->number, 0u);
  const SampleWriters::Entry* eight = sut.of(handle_of(8));
  ASSERT_NE(eight, nullptr);
  EXPECT_EQ(eight->number, 1u);
  EXPECT_EQ(sut.of(handle_of(9)), nullptr);
  EXPECT_EQ(sut.of(handle_of(7)), seven);
  EXPECT_EQ(sut.of(handle_of(8)), eight);
}

}  // namespace
}  // namespace stillhand::runtime::found_writers_test
