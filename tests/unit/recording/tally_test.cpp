// SPDX-License-Identifier: Apache-2.0
#include "services/bus/recording/tally.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <optional>

#include "idl/idl_text.hpp"
#include "idl/topics.hpp"
#include "services/bus/recording/trial_log.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/core/recording/mcap/sample_clock.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/session_file.hpp"

namespace stillhand::recording::tally_test {
namespace {

using runtime::FoundWriter;
using testing::ElementsAre;
using testing::Pair;

FoundWriter writer_of(const topics::Topic& topic, const std::string& id) {
  FoundWriter writer;
  writer.topic = topic.name;
  writer.type = topic.type;
  writer.id = id;
  writer.participant = "stillhand/1/" + id;
  writer.idl = topics::idl_of(topic.type);
  return writer;
}

std::vector<std::byte> sensed(Tick tick) {
  stillhand_msgs::Sensed message;
  message.rig(7);
  message.tick(tick);
  message.stamp_ns(tick * 1'000'000 + 3);
  return to_cdr(message);
}

TEST(SampleHeadTest, ItIsTheFirstThreeFieldsOfEvery1kHzMessage) {
  const SampleHead sut = sample_head(sensed(123'456'789'012));
  EXPECT_EQ(sut.rig, 7u);
  EXPECT_EQ(sut.tick, 123'456'789'012);
  EXPECT_EQ(sut.stamp_ns, 123'456'789'012'000'003);
}

TEST(SampleHeadTest, OtherBytesHaveNoTick) {
  auto bytes = sensed(5);
  bytes[1] = std::byte{0};  // big-endian
  EXPECT_EQ(sample_head(bytes).tick, -1);
  const auto whole = sensed(5);
  for (std::size_t length = 0; length < 28; ++length) {
    EXPECT_EQ(sample_head(std::span(whole).first(length)).tick, -1) << length;
  }
  EXPECT_EQ(sample_head(std::span(whole).first(28)).tick, 5);
}

class TallyTest : public testing::Test {
 protected:
  TallyTest() {
    TapeOptions options;
    options.path = (folder_ / "t.mcap").string();
    options.min_free_bytes = 0;
    tape_.emplace(std::move(options));
    sut_.emplace(&*tape_);
  }
  void take(const FoundWriter& writer, std::size_t number, std::int64_t sequence,
            std::span<const std::byte> bytes) {
    const std::int64_t at_ns = ++time_ns_;
    sut_->take(writer, {number, sequence, at_ns, at_ns, at_ns, bytes});
  }

  const support::Folder folder_;
  std::optional<Tape> tape_;
  std::optional<Tally> sut_;
  std::int64_t time_ns_ = 0;
};

TEST_F(TallyTest, EachWriterHasItsOwnCountsAndItsTopicHasTheirSum) {
  const FoundWriter first = writer_of(topics::kSensed, "first");
  const FoundWriter second = writer_of(topics::kSensed, "second");
  for (const Tick tick : {0, 1, 2, 5}) take(first, 0, tick + 1, sensed(tick));
  for (const Tick tick : {100, 101, 103}) take(second, 1, tick, sensed(tick));
  take(second, 1, 104, sensed(105));  // tick 104 never reached its DDS
  ASSERT_TRUE(tape_->close().ok());
  const auto topics = sut_->topics({first, second});
  ASSERT_EQ(topics.size(), 1u);
  const TopicTally& tally = topics.at("stillhand/sensed");
  EXPECT_EQ(tally.writers, 2u);
  EXPECT_EQ(tally.received, 8u);
  EXPECT_EQ(tally.lost, 4u);
  EXPECT_EQ(tally.not_sent, 1u);
  EXPECT_EQ(tally.written, 8u);
  EXPECT_TRUE(tally.type_known);
}

TEST_F(TallyTest, AWantedWriterWithoutSamplesHasZerosAndAnUnwantedOneIsLeftOut) {
  FoundWriter silent = writer_of(topics::kEvent, "silent");
  silent.idl = {};
  FoundWriter unwanted = writer_of(topics::kRigTruth, "unwanted");
  unwanted.wanted = false;
  const auto topics = sut_->topics({silent, unwanted});
  ASSERT_EQ(topics.size(), 1u);
  EXPECT_EQ(topics.at("stillhand/event").writers, 1u);
  EXPECT_EQ(topics.at("stillhand/event").received, 0u);
  EXPECT_FALSE(topics.at("stillhand/event").type_known);
  EXPECT_TRUE(sut_->heard().empty());
  EXPECT_TRUE(sut_->texts().empty());
}

// An event carries a tick that is no sample number.
TEST_F(TallyTest, TicksOfATopicThatIsNoStreamAreNoLoss) {
  const FoundWriter writer = writer_of(topics::kEvent, "rig");
  stillhand_msgs::Event event;
  event.rig(1);
  std::int64_t sequence = 0;
  for (const Tick tick : {10, 5000, 90}) {
    event.tick(tick);
    take(writer, 3, ++sequence, to_cdr(event));
  }
  EXPECT_EQ(sut_->topics({}).at("stillhand/event").lost, 0u);
  EXPECT_THAT(sut_->heard(), ElementsAre("stillhand/event"));
}

TEST_F(TallyTest, TheTextsHaveTheCountsOfEachTopic) {
  take(writer_of(topics::kSensed, "sensing"), 0, 1, sensed(1));
  take(writer_of(topics::kSensed, "sensing"), 0, 4, sensed(4));
  ASSERT_TRUE(tape_->close().ok());
  EXPECT_THAT(
      sut_->texts(),
      ElementsAre(Pair("stillhand/sensed late", "0"), Pair("stillhand/sensed lost", "2"),
                  Pair("stillhand/sensed not_sent", "0"), Pair("stillhand/sensed received", "2"),
                  Pair("stillhand/sensed written", "2")));
}

// 5 ns are offered. The sample before that at 30 ns was lost, so nobody knows when it was sent.
TEST_F(TallyTest, ASampleLaterThanTheOfferedDeadlineAfterTheOneBeforeIsLate) {
  FoundWriter writer = writer_of(topics::kEvent, "rig");
  writer.qos.deadline_ns = 5;
  struct Sent {
    std::int64_t sequence, at_ns;
  };
  for (const auto& [sequence, at_ns] : {Sent{1, 10}, {2, 15}, {3, 21}, {5, 30}, {6, 35}, {7, 99}}) {
    sut_->take(writer, {0, sequence, at_ns, at_ns, at_ns, sensed(1)});
  }
  EXPECT_EQ(sut_->topics({}).at("stillhand/event").late, 2u);
}

TEST_F(TallyTest, TheChannelOfAWriterStatesItsOrigin) {
  FoundWriter writer = writer_of(topics::kSensed, "1.f");
  writer.profile = "stream_1khz";
  writer.replayed = true;
  take(writer, 0, 1, sensed(1));
  ASSERT_TRUE(tape_->close().ok());
  FileSource file((folder_ / "t.mcap").string());
  const McapReader reader(file);
  ASSERT_EQ(reader.channels().size(), 1u);
  const Channel& channel = reader.channels().begin()->second;
  EXPECT_EQ(channel.topic, "stillhand/sensed");
  EXPECT_EQ(channel.metadata.at("writer"), "1.f");
  EXPECT_EQ(channel.metadata.at("participant"), "stillhand/1/1.f");
  EXPECT_EQ(channel.metadata.at("qos_profile"), "stream_1khz");
  EXPECT_EQ(channel.metadata.at("replayed"), "true");
  EXPECT_EQ(reader.schemas().at(channel.schema_id).name, "stillhand_msgs::Sensed");
}

std::vector<std::byte> control(std::int32_t trial, stillhand_msgs::Phase phase) {
  stillhand_msgs::TrialControl message;
  message.trial(trial);
  message.phase(phase);
  message.start_tick(3000 + trial);
  message.duration_ticks(10'000);
  message.reference_seed(UINT64_MAX);
  return to_cdr(message);
}

void announce(TrialLog& log, std::span<const std::byte> bytes) {
  log.take(writer_of(topics::kTrialControl, "experiment"), {0, 1, 1, 1, 1, bytes});
}

TEST(TrialLogTest, EachTrialIsListedWithItsTicksAndSeed) {
  TrialLog sut;
  EXPECT_EQ(sut.newest(), -1);
  announce(sut, control(0, stillhand_msgs::PHASE_PEGGED));
  announce(sut, control(2, stillhand_msgs::PHASE_TRACKING));
  EXPECT_EQ(sut.newest(), 2);
  EXPECT_THAT(
      sut.texts(),
      ElementsAre(Pair("trial 0 duration_ticks", "10000"), Pair("trial 0 phase", "pegged"),
                  Pair("trial 0 reference_seed", "18446744073709551615"),
                  Pair("trial 0 start_tick", "3000"), Pair("trial 2 duration_ticks", "10000"),
                  Pair("trial 2 phase", "tracking"),
                  Pair("trial 2 reference_seed", "18446744073709551615"),
                  Pair("trial 2 start_tick", "3002")));
}

TEST(TrialLogTest, OtherTopicsOtherTypesCutBytesAndNoTrialAreIgnored) {
  TrialLog sut;
  const auto whole = control(1, stillhand_msgs::PHASE_TRACKING);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    announce(sut, std::span(whole).first(length));
  }
  announce(sut, control(-1, stillhand_msgs::PHASE_IDLE));
  FoundWriter stranger = writer_of(topics::kTrialControl, "stranger");
  stranger.type = "strange::Type";
  sut.take(stranger, {0, 1, 1, 1, 1, whole});
  sut.take(writer_of(topics::kSensed, "sensing"), {0, 1, 1, 1, 1, whole});
  EXPECT_EQ(sut.newest(), -1);
  EXPECT_TRUE(sut.texts().empty());
  announce(sut, whole);
  EXPECT_EQ(sut.newest(), 1);
}

}  // namespace
}  // namespace stillhand::recording::tally_test
