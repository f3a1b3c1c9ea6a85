// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/feed/words.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "idl/topics.hpp"

namespace stillhand::dashboard::words_test {

TEST(WordsTest, EveryKindOfEventHasANameOfItsOwn) {
  std::set<std::string> names;
  for (std::uint32_t kind = 0;
       kind <= static_cast<std::uint32_t>(stillhand_msgs::EVENT_SECOND_WRITER); ++kind) {
    const std::string name = word(static_cast<stillhand_msgs::EventKind>(kind));
    EXPECT_NE(name, "unknown") << kind;
    EXPECT_TRUE(names.insert(name).second) << name;
  }
}

// The number comes from the bus.
TEST(WordsTest, AKindThatTheIdlDoesNotDefineIsUnknownAndHealthy) {
  for (const unsigned kind : {static_cast<std::uint32_t>(stillhand_msgs::EVENT_SECOND_WRITER) + 1,
                              1000u, 0x7FFF'FFFFu, UINT32_MAX}) {
    const auto strange = static_cast<stillhand_msgs::EventKind>(kind);
    EXPECT_STREQ(word(strange), "unknown") << kind;
    EXPECT_EQ(level_of(strange), Level::kHealthy) << kind;
  }
}

TEST(WordsTest, LossOfAProcessAnOpenInterlockAndQosAreCriticalAndAReturnIsHealthy) {
  using namespace stillhand_msgs;
  for (const auto kind : {EVENT_LIVELINESS_LOST, EVENT_INTERLOCK_OPENED, EVENT_INCOMPATIBLE_QOS,
                          EVENT_SECOND_WRITER}) {
    EXPECT_EQ(level_of(kind), Level::kCritical) << word(kind);
  }
  for (const auto kind : {EVENT_DEADLINE_MISSED, EVENT_CYCLE_MISSED, EVENT_TICKS_LOST,
                          EVENT_MODEL_REFUSED, EVENT_CLOCK_STEPPED, EVENT_CLOCK_DRIFTS}) {
    EXPECT_EQ(level_of(kind), Level::kWarning) << word(kind);
  }
  for (const auto kind : {EVENT_LIVELINESS_RECOVERED, EVENT_FORCE_ZERO, EVENT_MODEL_LOADED,
                          EVENT_NOTE, EVENT_COMMAND}) {
    EXPECT_EQ(level_of(kind), Level::kHealthy) << word(kind);
  }
}

TEST(WordsTest, EveryWatchHasANameOfItsOwnAndCountsOnlyLossesInTicks) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < kWatches; ++i) {
    const auto watch = static_cast<Watch>(i);
    EXPECT_TRUE(names.insert(word(watch)).second) << word(watch);
    EXPECT_STREQ(unit(watch), watch == Watch::kLost ? "ticks" : "ms");
  }
}

TEST(WordsTest, ATopicWithOneWriterNamesItAndOthersNameNone) {
  for (const topics::Topic* topic : topics::kCatalogue) {
    const std::string_view writer = writer_of(std::string(topic->name));
    EXPECT_EQ(writer.empty(), topic->writers.size() != 1) << topic->name;
    if (!writer.empty()) {
      EXPECT_EQ(writer, topic->writers.front()) << topic->name;
    }
  }
  EXPECT_EQ(writer_of(std::string(topics::kSensed.name)), "sensing");
  EXPECT_EQ(writer_of("stranger/topic"), "");
  EXPECT_EQ(writer_of(""), "");
}

}  // namespace stillhand::dashboard::words_test
