// SPDX-License-Identifier: Apache-2.0
// Real files in a folder of the test's own.
#include "services/bus/recording/tape.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <stdexcept>

#include "services/bus/recording/qos_texts.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/recorded_file.hpp"
#include "tests/support/wait.hpp"

namespace stillhand::recording::tape_test {
namespace {

using support::eventually;

class TapeTest : public testing::Test {
 protected:
  TapeOptions options() const {
    TapeOptions options;
    options.path = (folder_ / "t.mcap").string();
    options.min_free_bytes = 0;
    options.session = {{"host", "h"}};
    return options;
  }
  static std::uint32_t channel(Tape& tape, const std::string& topic = "a") {
    Channel channel;
    channel.topic = topic;
    channel.message_encoding = kMessageEncoding;
    return tape.add_channel(channel, "T", "struct T { long x; };");
  }
  /// `count` messages, 1 ms apart; sequence numbers and log times count from `first`.
  static void put(Tape& tape, std::uint32_t to, int first, int count) {
    const std::vector<std::byte> bytes(100, std::byte{7});
    for (int i = first; i < first + count; ++i) {
      tape.put(to, static_cast<std::uint32_t>(i), 1'000'000LL * (i + 1), 1'000'000LL * i,
               1'000'000LL * (i + 1), bytes);
    }
  }
  static std::vector<std::uint32_t> sequences(const std::string& path) {
    FileSource file(path);
    McapReader reader(file);
    EXPECT_TRUE(reader.indexed()) << path;
    std::vector<std::uint32_t> found;
    for (const auto& message : tests::messages_of(reader)) found.push_back(message.sequence);
    EXPECT_TRUE(reader.status().ok());
    EXPECT_TRUE(reader.damage().empty());
    return found;
  }

  const support::Folder folder_;
};

TEST_F(TapeTest, FurtherMetadataStandsAtTheBeginningOfEveryFile) {
  TapeOptions wanted = options();
  wanted.first_words = {{"stillhand.experiment", {{"participant", "P07"}}}};
  wanted.rotation.max_ns = 100'000'000;
  Tape sut(wanted);
  put(sut, channel(sut), 0, 250);
  ASSERT_TRUE(sut.close().ok());
  ASSERT_GE(sut.status().parts, 2u);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    FileSource file(entry.path().string());
    McapReader reader(file);
    ASSERT_NE(reader.find_metadata("stillhand.experiment"), nullptr) << entry.path();
    EXPECT_EQ(reader.find_metadata("stillhand.experiment")->texts.at("participant"), "P07");
  }
}

TEST_F(TapeTest, EveryMessageIsInTheFileInItsOrderAndCounted) {
  Tape sut(options());
  put(sut, channel(sut), 0, 5000);
  ASSERT_TRUE(sut.close().ok());
  const auto found = sequences(options().path);
  ASSERT_EQ(found.size(), 5000u);
  for (std::uint32_t i = 0; i < 5000; ++i) ASSERT_EQ(found[i], i);
  EXPECT_EQ(sut.status().written, 5000u);
  EXPECT_EQ(sut.written_by_channel(), std::vector<std::uint64_t>{5000});
  EXPECT_EQ(sut.status().dropped, 0u);
}

TEST_F(TapeTest, TheSessionStandsFirstAndTheLastWordsLast) {
  auto with_words = options();
  with_words.last_words = [] { return std::vector<Metadata>{{"end", {{"k", "v"}}}}; };
  Tape sut(with_words);
  ASSERT_TRUE(sut.close().ok());
  FileSource file(options().path);
  const McapReader reader(file);
  ASSERT_EQ(reader.metadata().size(), 2u);
  EXPECT_EQ(reader.metadata()[0].texts.at("host"), "h");
  EXPECT_EQ(reader.metadata()[0].texts.at("part"), "1");
  EXPECT_EQ(reader.metadata()[1].name, "end");
}

TEST_F(TapeTest, RotationByTimeLosesNothingAndEveryPartReadsAlone) {
  auto rotating = options();
  rotating.rotation.max_ns = 100'000'000;
  Tape sut(rotating);
  put(sut, channel(sut), 0, 250);
  ASSERT_TRUE(sut.close().ok());
  EXPECT_EQ(sut.status().parts, 3u);
  std::vector<std::uint32_t> all;
  for (std::uint32_t part = 1; part <= 3; ++part) {
    const auto found = sequences(part_name(rotating.path, part));
    EXPECT_LE(found.size(), 100u);
    all.insert(all.end(), found.begin(), found.end());
  }
  ASSERT_EQ(all.size(), 250u);
  for (std::uint32_t i = 0; i < 250; ++i) ASSERT_EQ(all[i], i);
}

// Not after an hour, and not at once: the writer's interval of chunks is longer than this test.
TEST_F(TapeTest, WhatWasPutIsInTheFileAfterASync) {
  TapeOptions slow = options();
  slow.flush_interval_ns = 3'600'000'000'000;
  Tape sut(slow);
  put(sut, channel(sut), 0, 100);
  ASSERT_TRUE(sut.sync());
  FileSource file(slow.path);
  McapReader reader(file);
  EXPECT_EQ(tests::messages_of(reader).size(), 100u);
}

TEST_F(TapeTest, AClockThatIsSetStartsNoNewFile) {
  auto rotating = options();
  rotating.rotation.max_ns = 1'000'000'000;
  Tape sut(rotating);
  const std::uint32_t to = channel(sut);
  const std::vector<std::byte> bytes(100, std::byte{7});
  for (const std::int64_t set_ns : {std::int64_t{0}, std::int64_t{3'600'000'000'000}}) {
    sut.put(to, 0, set_ns + 1, set_ns + 1, set_ns / 1'000'000, bytes);
  }
  ASSERT_TRUE(sut.close().ok());
  EXPECT_EQ(sut.status().parts, 1u);
}

// A stranger that comes again and again has a channel each time.
TEST_F(TapeTest, BeyondTheChannelsOfMcapMessagesAreDroppedAndCountedAndTheFileIsWhole) {
  Tape sut(options());
  const std::vector<std::byte> bytes(4, std::byte{7});
  for (std::uint32_t i = 0; i <= McapWriter::kMaxIds; ++i) {
    sut.put(channel(sut), i, 1 + i, 1 + i, 1 + i, bytes);
  }
  ASSERT_TRUE(sut.close().ok());
  EXPECT_EQ(sut.status().dropped, 1u);
  EXPECT_EQ(sequences(options().path).size(), McapWriter::kMaxIds);
}

TEST_F(TapeTest, RotationBySizeKeepsPartsNearIt) {
  auto rotating = options();
  rotating.writer.chunk_bytes = 4096;
  rotating.writer.compression = Compression::kNone;
  rotating.rotation.max_bytes = 20'000;
  Tape sut(rotating);
  put(sut, channel(sut), 0, 1000);
  ASSERT_TRUE(sut.close().ok());
  EXPECT_GT(sut.status().parts, 3u);
  std::size_t all = 0;
  for (std::uint32_t part = 1; part <= sut.status().parts; ++part) {
    all += sequences(part_name(rotating.path, part)).size();
  }
  EXPECT_EQ(all, 1000u);
  // A full file is left at the next message: one chunk more, its index, and the summary.
  EXPECT_LT(std::filesystem::file_size(rotating.path), 20'000u + 3 * 4096u);
}

TEST_F(TapeTest, APartThatIsThereAlreadyIsNotOverwrittenAndEndsTheTape) {
  {
    const FileSink taken((folder_ / "t.0002.mcap").string());
  }
  auto rotating = options();
  rotating.rotation.max_ns = 100'000'000;
  Tape sut(rotating);
  put(sut, channel(sut), 0, 250);
  const Status status = sut.close();
  EXPECT_FALSE(status.ok());
  EXPECT_NE(status.text.find("t.0002.mcap"), std::string::npos);
  EXPECT_EQ(std::filesystem::file_size(folder_ / "t.0002.mcap"), 0u);
  EXPECT_EQ(sut.status().written + sut.status().dropped, 250u);
  EXPECT_EQ(sequences(options().path).size(), sut.status().written);
}

TEST_F(TapeTest, APauseIsCountedAndNotLost) {
  Tape sut(options());
  const std::uint32_t to = channel(sut);
  put(sut, to, 0, 10);
  sut.set_paused(true);
  put(sut, to, 10, 10);
  sut.set_paused(false);
  put(sut, to, 20, 10);
  ASSERT_TRUE(sut.close().ok());
  EXPECT_EQ(sut.status().written, 20u);
  EXPECT_EQ(sut.status().passed_over, 10u);
  EXPECT_EQ(sut.status().dropped, 0u);
}

TEST_F(TapeTest, TheEventWindowIsWrittenAtATriggerAndAtNoOtherTime) {
  auto windowed = options();
  windowed.window_ns = 50'000'000;
  Tape sut(windowed);
  const std::uint32_t to = channel(sut);
  put(sut, to, 0, 200);
  ASSERT_TRUE(eventually([&] {
    const TapeStatus status = sut.status();
    return status.held > 0 && status.held + status.passed_over == 200;
  }));
  EXPECT_EQ(sut.status().written, 0u);
  sut.trigger("a test");
  ASSERT_TRUE(eventually([&] { return sut.status().written > 0; }));
  put(sut, to, 200, 5);
  ASSERT_TRUE(sut.close().ok());
  const auto found = sequences(options().path);
  ASSERT_GE(found.size(), 50u);
  EXPECT_EQ(found.back(), 199u);
  EXPECT_EQ(sut.status().written + sut.status().passed_over, 205u);
  FileSource file(options().path);
  const McapReader reader(file);
  const Metadata* trigger = reader.find_metadata("stillhand.trigger");
  ASSERT_NE(trigger, nullptr);
  EXPECT_EQ(trigger->texts.at("cause"), "a test");
}

TEST_F(TapeTest, WhatDoesNotFitTheQueueIsDroppedAndCounted) {
  auto small = options();
  small.max_queued_bytes = 1000;
  Tape sut(small);
  put(sut, channel(sut), 0, 10'000);
  ASSERT_TRUE(sut.close().ok());
  EXPECT_GT(sut.status().dropped, 0u);
  EXPECT_EQ(sut.status().written + sut.status().dropped, 10'000u);
}

TEST_F(TapeTest, AMessageThatAFileCannotHoldIsDroppedAndCountedAndTheTapeGoesOn) {
  Tape sut(options());
  const std::uint32_t a = channel(sut);
  sut.put(a, 0, 1, 1, 1, std::vector<std::byte>(McapWriter::kMaxMessageBytes + 1));
  sut.put(a, 1, 2, 2, 2, std::vector<std::byte>(4));
  ASSERT_TRUE(sut.close().ok());
  EXPECT_EQ(sut.status().dropped, 1u);
  EXPECT_THAT(sequences(options().path), testing::ElementsAre(1u));
}

TEST_F(TapeTest, OneNameWithTwoDefinitionsAndOneWithoutAreThreeSchemas) {
  Tape sut(options());
  std::vector<std::uint32_t> channels;
  for (const std::string text : {"struct T { long x; };", "struct T { long y; };", ""}) {
    channels.push_back(sut.add_channel({}, "T", text));
  }
  for (const std::uint32_t each : channels) sut.put(each, 1, 1, 1, 1, std::vector<std::byte>(4));
  ASSERT_TRUE(sut.close().ok());
  FileSource file(options().path);
  const McapReader reader(file);
  std::vector<std::string> found;
  for (const auto& [id, channel] : reader.channels()) {
    const Schema& schema = reader.schemas().at(channel.schema_id);
    EXPECT_EQ(schema.name, "T");
    found.push_back(schema.encoding + " " + std::to_string(schema.bytes.size()));
  }
  EXPECT_THAT(found, testing::ElementsAre("omgidl 21", "omgidl 21", " 0"));
}

TEST_F(TapeTest, ADiskThatIsTooFullIsRefusedBeforeTheRun) {
  auto full = options();
  full.min_free_bytes = UINT64_MAX;
  EXPECT_THROW(Tape{full}, ConfigError);
  EXPECT_FALSE(std::filesystem::exists(full.path));
}

// A bound on the size of files stands in for the disk.
TEST_F(TapeTest, AFileThatCannotBeWrittenIsNotLeftBehind) {
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old), 0);
  const rlimit none{0, old.rlim_max};
  const auto disposition = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &none), 0);
  EXPECT_THROW(Tape{options()}, std::runtime_error);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old), 0);
  std::signal(SIGXFSZ, disposition);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST(QosTextsTest, EveryPolicyComesBackFromItsText) {
  runtime::WriterQos qos;
  qos.reliable = true;
  qos.durability = runtime::Durability::kTransientLocal;
  qos.liveliness = runtime::Liveliness::kManualByTopic;
  qos.exclusive = true;
  qos.deadline_ns = 5'500'000;
  qos.lifespan_ns = 20'000'000;
  qos.lease_ns = 300'000'000;
  qos.xcdr2 = true;
  qos.keyed = true;
  for (const std::int32_t depth : {16, 0, -1}) {
    qos.depth = depth;
    EXPECT_EQ(qos_of(qos_texts(qos)), qos);
  }
  EXPECT_EQ(qos_of(qos_texts({})), runtime::WriterQos{});
  EXPECT_FALSE(qos_of({{"offered_qos_profiles", "- reliability: 1"}}).has_value());
  auto strange = qos_texts(qos);
  strange["qos.deadline_ns"] = "-5";
  strange["qos.durability"] = "eternal";
  EXPECT_EQ(qos_of(strange)->deadline_ns, runtime::kForever_ns);
  EXPECT_EQ(qos_of(strange)->durability, runtime::Durability::kVolatile);
}

}  // namespace
}  // namespace stillhand::recording::tape_test
