// SPDX-License-Identifier: Apache-2.0
// Which writer a process listens to decides who moves the motor.
#include "services/bus/sources.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/sources_codec.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/unit/runtime/announced.hpp"

namespace stillhand::runtime::sources_test {
namespace {

using announced::handle_of;
using announced::prefix_of;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint32_t kRig = 3;
constexpr std::uint8_t kStranger = 70;
constexpr const char* kMotor = "stillhand/motor_command";

ParticipantId id_of(std::uint8_t number) {
  ParticipantId id{};
  std::ranges::copy(prefix_of(number).value, id.begin());
  return id;
}

std::size_t place_of(std::string_view service) {
  return static_cast<std::size_t>(std::ranges::find(topics::kServices, service) -
                                  topics::kServices.begin());
}

// Participant 1 is the first service's, and so on; `from` more in another session.
std::uint8_t number_of(std::string_view service, std::uint8_t from = 1) {
  return static_cast<std::uint8_t>(from + place_of(service));
}

std::vector<Source> all_sources(std::uint8_t from = 1) {
  std::vector<Source> sources;
  for (const std::string_view service : topics::kServices) {
    sources.push_back({std::string(service), id_of(number_of(service, from))});
  }
  return sources;
}

class SourcesTest : public testing::Test {
 protected:
  Sources::Options options() {
    Sources::Options options;
    options.rig = kRig;
    options.on_second = [this](const Sources::Second& second) {
      told_.push_back(std::string(second.topic->name) + " " + second.name);
    };
    return options;
  }
  static ParticipantId experiment(std::uint8_t from = 1) {
    return id_of(number_of("experiment", from));
  }
  [[nodiscard]] static bool motor_from(const Sources& sut, std::uint8_t participant) {
    return sut.admits(place_of("cancellation"), handle_of(participant));
  }

  std::vector<std::string> told_;
  Sources sut_{options()};
};

TEST_F(SourcesTest, BeforeTheyAreNamedNobodyIsASourceAndAnyExperimentIsHeard) {
  EXPECT_FALSE(sut_.named());
  EXPECT_FALSE(sut_.sound());
  EXPECT_FALSE(motor_from(sut_, number_of("cancellation")));
  EXPECT_TRUE(sut_.admits(place_of("experiment"), handle_of(number_of("experiment"))));
  EXPECT_STREQ(sut_.why_not(), "the session has not named its sources");
}

TEST_F(SourcesTest, OnlyTheNamedParticipantIsTheSourceOfEachProcess) {
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  EXPECT_TRUE(sut_.sound());
  for (const std::string_view service : topics::kServices) {
    for (std::uint8_t other = 0; other < 20; ++other) {
      EXPECT_EQ(sut_.admits(place_of(service), handle_of(other)), other == number_of(service))
          << service << " " << int{other};
    }
  }
  // Any writer of that participant; of a topic that all may write, anybody.
  EXPECT_TRUE(sut_.admits(place_of("rig"), handle_of(number_of("rig"), 9)));
  EXPECT_TRUE(sut_.admits(Sources::kAnybody, handle_of(kStranger)));
}

// Of a topic that several processes write, each message says whose it is.
TEST_F(SourcesTest, OnlyTheNamedParticipantSpeaksForAProcess) {
  EXPECT_TRUE(sut_.speaks_for("rig", id_of(kStranger)));  // each process says that it starts
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  for (const std::string_view service : topics::kServices) {
    for (std::uint8_t other = 0; other < 20; ++other) {
      EXPECT_EQ(sut_.speaks_for(service, id_of(other)), other == number_of(service)) << service;
    }
  }
  EXPECT_FALSE(sut_.speaks_for("stranger", id_of(kStranger)));
}

// It moves nothing, so the interlock stays closed.
TEST_F(SourcesTest, AWordInAProcesssNameIsToldOnceAndOpensNothing) {
  const std::string status(topics::kServiceStatus.name);
  sut_.note_participant(prefix_of(kStranger), "somebody");
  sut_.note_writer(handle_of(kStranger), status);
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  EXPECT_THAT(told_, IsEmpty());
  sut_.note_refused(handle_of(kStranger));
  sut_.note_refused(handle_of(kStranger));
  EXPECT_THAT(told_, ElementsAre(status + " somebody"));
  EXPECT_TRUE(sut_.sound());
}

// Every byte of the number counts.
TEST_F(SourcesTest, AParticipantThatDiffersInOneByteIsNotTheSource) {
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  for (std::size_t byte = 0; byte < 12; ++byte) {
    auto guid = announced::guid_of(number_of("cancellation"));
    guid.guidPrefix.value[byte] ^= 1;
    EXPECT_FALSE(sut_.admits(place_of("cancellation"), Sources::Handle(guid))) << byte;
  }
}

TEST_F(SourcesTest, AListThatIsNotASessionsIsRefused) {
  const auto refused = [&](const char* what, auto change) {
    std::vector<Source> sources = all_sources();
    change(sources);
    EXPECT_FALSE(sut_.take(experiment(), sources)) << what;
    EXPECT_FALSE(sut_.named()) << what;
  };
  refused("one is missing", [](auto& list) { list.pop_back(); });
  refused("one is there twice", [](auto& list) { list.front().service = list.back().service; });
  refused("one more", [](auto& list) { list.push_back(list.front()); });
  refused("an unknown one", [](auto& list) { list.front().service = "stranger"; });
  refused("another experiment",
          [](auto& list) { list[place_of("experiment")].participant = id_of(kStranger); });
}

TEST_F(SourcesTest, AProcessThatALabStartedListensToThatLabAlone) {
  Sources::Options wanted = options();
  wanted.experiment = experiment(20);
  Sources sut(wanted);
  EXPECT_FALSE(sut.admits(place_of("experiment"), handle_of(number_of("experiment"))));
  EXPECT_TRUE(sut.admits(place_of("experiment"), handle_of(number_of("experiment", 20))));
  EXPECT_FALSE(sut.take(experiment(), all_sources()));
  EXPECT_TRUE(sut.take(experiment(20), all_sources(20)));
  sut.forget_participant(prefix_of(number_of("experiment", 20)));
  EXPECT_FALSE(sut.named());
  EXPECT_FALSE(sut.admits(place_of("experiment"), handle_of(number_of("experiment"))));
}

// An experiment that stood still for longer than DDS waits is a participant that left and came
// back.
TEST_F(SourcesTest, AnExperimentThatComesBackNamesItsSourcesAgain) {
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  sut_.forget_participant(prefix_of(number_of("experiment")));
  EXPECT_FALSE(sut_.named());
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(sut_.take(experiment(), all_sources()));
    EXPECT_TRUE(sut_.sound());
    EXPECT_TRUE(motor_from(sut_, number_of("cancellation")));
  }
}

// A lab that was killed leaves its participant behind for a while; the next one already speaks.  Or
// the first is a stranger, who waited for the lab.
TEST_F(SourcesTest, OfTwoExperimentsNoneCountsUntilOneLeft) {
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  ASSERT_TRUE(sut_.take(experiment(20), all_sources(20)));
  EXPECT_FALSE(sut_.sound());
  EXPECT_STREQ(sut_.why_not(), "two experiments name the session's sources");
  EXPECT_FALSE(sut_.admits(place_of("experiment"), handle_of(kStranger)));
  EXPECT_FALSE(motor_from(sut_, number_of("cancellation")));
  EXPECT_FALSE(motor_from(sut_, number_of("cancellation", 20)));
  for (const std::uint8_t from : {std::uint8_t{1}, std::uint8_t{20}}) {
    EXPECT_FALSE(sut_.admits(place_of("experiment"), handle_of(number_of("experiment", from))));
  }
  sut_.forget_participant(prefix_of(number_of("experiment")));
  EXPECT_FALSE(motor_from(sut_, number_of("cancellation")));
  EXPECT_TRUE(motor_from(sut_, number_of("cancellation", 20)));
  sut_.forget_participant(prefix_of(number_of("experiment", 20)));
  EXPECT_FALSE(sut_.named());
}

TEST_F(SourcesTest, ASecondWriterIsNamedOnceAndCountsUntilItLeaves) {
  sut_.note_participant(prefix_of(kStranger), "a stranger");
  sut_.note_writer(handle_of(kStranger), kMotor);  // before the session
  EXPECT_THAT(told_, IsEmpty());
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  EXPECT_FALSE(sut_.sound());
  EXPECT_STREQ(sut_.why_not(), "a second writer of stillhand/motor_command: a stranger");
  sut_.note_writer(handle_of(kStranger, 2), "stillhand/sensed");
  EXPECT_THAT(told_,
              ElementsAre("stillhand/motor_command a stranger", "stillhand/sensed a stranger"));
  sut_.forget_writer(handle_of(kStranger, 2));
  EXPECT_FALSE(sut_.sound());
  sut_.forget_participant(prefix_of(kStranger));
  EXPECT_TRUE(sut_.sound());
  // The rig reports why the interlock opened after it opened.
  EXPECT_STREQ(sut_.why_not(), "a second writer of stillhand/sensed: a stranger");
}

TEST_F(SourcesTest, TheSessionsOwnWritersAndSharedTopicsAreNoSecondWriters) {
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  for (const topics::Topic* topic : topics::kCatalogue) {
    if (Sources::writer_of(*topic) == Sources::kAnybody) {
      sut_.note_participant(prefix_of(kStranger), "a stranger");
      sut_.note_writer(handle_of(kStranger), std::string(topic->name));
    } else {
      const std::uint8_t number = number_of(topic->writers.front());
      sut_.note_participant(prefix_of(number),
                            "stillhand/3/" + std::string(topic->writers.front()));
      sut_.note_writer(handle_of(number), std::string(topic->name));
    }
  }
  sut_.note_writer(handle_of(kStranger), "a topic of their own");
  EXPECT_TRUE(sut_.sound());
  EXPECT_THAT(told_, IsEmpty());
}

// Its writers are announced before its name.
TEST_F(SourcesTest, AWriterIsJudgedOnceItsParticipantHasAName) {
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  sut_.note_writer(handle_of(kStranger), kMotor);
  EXPECT_TRUE(sut_.sound());
  sut_.note_participant(prefix_of(kStranger), "");
  EXPECT_FALSE(sut_.sound());
  EXPECT_THAT(told_, ElementsAre("stillhand/motor_command a participant without a name"));
}

TEST_F(SourcesTest, AnotherRigsProcessIsNoSecondWriterUntilItWritesForThisRig) {
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  sut_.note_participant(prefix_of(kStranger), "stillhand/31/cancellation");
  sut_.note_writer(handle_of(kStranger), kMotor);
  EXPECT_TRUE(sut_.sound());
  sut_.note_refused(handle_of(kStranger));
  EXPECT_FALSE(sut_.sound());
  EXPECT_THAT(told_, ElementsAre("stillhand/motor_command stillhand/31/cancellation"));
  // The topic of another process is not its own.
  sut_.forget_participant(prefix_of(kStranger));
  sut_.note_participant(prefix_of(kStranger), "stillhand/31/display");
  sut_.note_writer(handle_of(kStranger), kMotor);
  EXPECT_FALSE(sut_.sound());
}

TEST_F(SourcesTest, ASecondProcessOfTheSameNameIsASecondWriter) {
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  sut_.note_participant(prefix_of(kStranger), "stillhand/3/cancellation");
  sut_.note_writer(handle_of(kStranger), kMotor);
  EXPECT_FALSE(sut_.sound());
}

TEST_F(SourcesTest, AReplayIsNoSecondWriterAndALateSampleOpensNothing) {
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  sut_.note_replay(prefix_of(kStranger));
  sut_.note_participant(prefix_of(kStranger), "stillhand-replay/1");
  sut_.note_writer(handle_of(kStranger), kMotor);
  sut_.note_refused(handle_of(kStranger));
  EXPECT_TRUE(sut_.sound());
  sut_.note_refused(handle_of(kStranger + 1));  // it left, and a sample was in the history
  EXPECT_TRUE(sut_.sound());
}

TEST_F(SourcesTest, AStrangersNameIsPrintedInPartAndManyStrangersUseNoMoreMemory) {
  ASSERT_TRUE(sut_.take(experiment(), all_sources()));
  sut_.note_participant(prefix_of(kStranger), "\x1b[2J" + std::string(300, 'x'));
  sut_.note_writer(handle_of(kStranger), kMotor);
  ASSERT_EQ(told_.size(), 1u);
  EXPECT_EQ(told_[0], "stillhand/motor_command ?[2J" + std::string(27, 'x'));
  for (int i = 0; i < 300; ++i) {
    auto guid = announced::guid_of(kStranger);
    guid.guidPrefix.value[5] = static_cast<std::uint8_t>(i);
    guid.guidPrefix.value[6] = static_cast<std::uint8_t>(1 + i / 256);
    sut_.note_participant(guid.guidPrefix, "stranger " + std::to_string(i));
    sut_.note_writer(Sources::Handle(guid), kMotor);
  }
  EXPECT_STREQ(sut_.why_not(), "more second writers than are named");
}

TEST_F(SourcesTest, WithKeysASourceHasTheIdentityOfItsProcess) {
  Sources::Options wanted = options();
  for (const std::string_view service : topics::kServices) {
    std::array<std::uint8_t, 6> start{};
    std::copy_n(id_of(number_of(service)).begin(), start.size(), start.begin());
    wanted.identities.push_back(start);
  }
  Sources sut(wanted);
  std::vector<Source> sources = all_sources();
  sources[place_of("cancellation")].participant = id_of(number_of("display"));
  EXPECT_FALSE(sut.take(experiment(), sources));
  EXPECT_FALSE(sut.take(experiment(20), all_sources(20)));
  EXPECT_TRUE(sut.take(experiment(), all_sources()));
}

TEST(SourcesCodecTest, AParticipantIsTheSameAfterTheBusAndNonsenseIsNothing) {
  const std::vector<Source> sources = all_sources();
  stillhand_msgs::SessionSources message = to_idl(sources);
  const auto back = from_idl(message);
  ASSERT_TRUE(back);
  ASSERT_EQ(back->size(), sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) {
    EXPECT_EQ((*back)[i].service, sources[i].service);
    EXPECT_EQ((*back)[i].participant, sources[i].participant);
  }
  for (const char* nonsense :
       {"", "0123", "0123456789abcdef0123456g", "0123456789ABCDEF01234567"}) {
    message.sources().front().participant(nonsense);
    EXPECT_FALSE(from_idl(message)) << nonsense;
  }
  EXPECT_THROW(participant_of("x", "--experiment"), ConfigError);
}

}  // namespace
}  // namespace stillhand::runtime::sources_test
