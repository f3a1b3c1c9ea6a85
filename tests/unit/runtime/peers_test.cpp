// SPDX-License-Identifier: Apache-2.0
// Who counts as alive decides whether the motor may push.
#include "services/bus/peers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "idl/topics.hpp"
#include "tests/unit/runtime/announced.hpp"

namespace stillhand::runtime::peers_test {
namespace {

using announced::gone;
using announced::handle_of;
using announced::participant;
using announced::writer;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint32_t kRig = 3;
constexpr std::uint8_t kReplay = 99;

class PeersTest : public testing::Test {
 protected:
  static void join(Peers& sut, std::uint8_t number, const std::string& name, bool marked = false) {
    sut.on_participant(participant(number, name, marked));
  }
  static void leave(Peers& sut, std::uint8_t number) {
    sut.on_participant(gone(participant(number, "")));
  }
  /// Number of a service's participant.
  static std::uint8_t number_of(std::string_view service) {
    const auto found = std::ranges::find(topics::kServices, service);
    return static_cast<std::uint8_t>(1 + (found - topics::kServices.begin()));
  }
  static void live(Peers& sut, std::string_view service) {
    const std::uint8_t number = number_of(service);
    join(sut, number, Peers::participant_name(kRig, std::string(service)));
    sut.set_alive(handle_of(number), true);
  }
  /// Every service but the rig, which asks.
  static void all_live(Peers& sut) {
    for (const std::string_view service : topics::kServices) {
      if (service != "rig") live(sut, service);
    }
  }
  static void authenticate(Peers& sut, std::uint8_t number) {
    ertps::ParticipantAuthenticationInfo info;
    info.guid = announced::guid_of(number);
    info.status = ertps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT;
    sut.onParticipantAuthentication(nullptr, std::move(info));
  }

  Peers sut_{"rig", kRig};
};

TEST_F(PeersTest, EverybodyIsAliveOnceEachOtherServiceShowsItsLifeSign) {
  for (const std::string_view service : topics::kServices) {
    if (service == "rig") continue;
    EXPECT_FALSE(sut_.alive()) << "before " << service;
    live(sut_, service);
  }
  EXPECT_TRUE(sut_.alive());
  EXPECT_THAT(sut_.lost(), IsEmpty());
}

TEST_F(PeersTest, ALifeSignThatEndsIsNamedUntilItComesBack) {
  all_live(sut_);
  EXPECT_TRUE(sut_.set_alive(handle_of(number_of("motion")), false));
  EXPECT_FALSE(sut_.alive());
  EXPECT_THAT(sut_.lost(), ElementsAre("motion"));
  EXPECT_FALSE(sut_.set_alive(handle_of(number_of("motion")), false));  // nothing new
  EXPECT_TRUE(sut_.set_alive(handle_of(number_of("motion")), true));
  EXPECT_TRUE(sut_.alive());
  EXPECT_THAT(sut_.lost(), IsEmpty());
}

TEST_F(PeersTest, ASampleIsALifeSignAsLongAsLivelinessWasNotHeardOf) {
  all_live(sut_);
  const auto writer = handle_of(number_of("motion") + 100U);
  sut_.set_alive(handle_of(number_of("motion")), false);
  join(sut_, number_of("motion") + 100U, Peers::participant_name(kRig, "motion"));
  EXPECT_TRUE(sut_.note_sample(writer));
  EXPECT_TRUE(sut_.alive());
  EXPECT_FALSE(sut_.note_sample(writer));  // nothing new
  // Its last samples may arrive after its death.
  EXPECT_TRUE(sut_.set_alive(writer, false));
  EXPECT_FALSE(sut_.note_sample(writer));
  EXPECT_FALSE(sut_.alive());
}

TEST_F(PeersTest, ALifeSignBeforeTheNameIsMadeUpForByASample) {
  for (const std::string_view service : topics::kServices) {
    if (service != "rig" && service != "motion") live(sut_, service);
  }
  const auto writer = handle_of(number_of("motion"));
  EXPECT_FALSE(sut_.set_alive(writer, true));  // a stranger so far
  EXPECT_FALSE(sut_.note_sample(writer));
  EXPECT_FALSE(sut_.alive());
  join(sut_, number_of("motion"), Peers::participant_name(kRig, "motion"));
  EXPECT_TRUE(sut_.note_sample(writer));
  EXPECT_TRUE(sut_.alive());
}

TEST_F(PeersTest, AnotherRigsServiceAndAStrangerGiveNoLifeSign) {
  all_live(sut_);
  sut_.set_alive(handle_of(number_of("motion")), false);
  join(sut_, 50, Peers::participant_name(kRig + 1, "motion"));
  join(sut_, 51, Peers::participant_name(kRig * 10, "motion"));
  join(sut_, 52, "motion");
  // 53 was never announced.
  for (const std::uint8_t stranger : std::array<std::uint8_t, 4>{50, 51, 52, 53}) {
    EXPECT_FALSE(sut_.set_alive(handle_of(stranger), true));
    EXPECT_EQ(sut_.service_of(handle_of(stranger)), "");
  }
  EXPECT_FALSE(sut_.alive());
}

// A service that was started again has a new writer; the end of the old one comes later.
TEST_F(PeersTest, OnlyWithNamedSourcesAndWithoutASecondWriterEverybodyIsAlive) {
  const auto id_of = [](std::string_view service) {
    ParticipantId id{};
    std::ranges::copy(announced::prefix_of(number_of(service)).value, id.begin());
    return id;
  };
  Sources sources({.rig = kRig, .experiment = {}, .identities = {}, .on_second = {}});
  Peers sut("rig", kRig, false, nullptr, false, &sources);
  all_live(sut);
  EXPECT_FALSE(sut.alive()) << "the session has not named its sources";
  std::vector<Source> named;
  for (const std::string_view service : topics::kServices) {
    named.push_back({std::string(service), id_of(service)});
  }
  ASSERT_TRUE(sut.take_sources(id_of("experiment"), named));
  EXPECT_TRUE(sut.alive());
  // A stranger under a process's name hides its loss from nobody.
  constexpr std::uint8_t kNamesake = 60;
  join(sut, kNamesake, Peers::participant_name(kRig, "motion"));
  sut.set_alive(handle_of(kNamesake), true);
  sut.set_alive(handle_of(number_of("motion")), false);
  EXPECT_FALSE(sut.alive());
  EXPECT_THAT(sut.lost(), ElementsAre("motion"));
  sut.set_alive(handle_of(number_of("motion")), true);
  EXPECT_TRUE(sut.alive());
  EXPECT_THAT(sut.lost(), IsEmpty());
  constexpr std::uint8_t kStranger = 70;
  join(sut, kStranger, "a stranger");
  sources.note_writer(handle_of(kStranger), "stillhand/motor_command");
  EXPECT_FALSE(sut.alive()) << "two writers of the motor command";
}

// The recorder counts them to know when the session's processes have gone.
TEST_F(PeersTest, AStrangersLifeSignThatEndsIsNobodysLoss) {
  join(sut_, 60, Peers::participant_name(kRig, "a stranger"));
  sut_.set_alive(handle_of(60), true);
  sut_.set_alive(handle_of(60), false);
  EXPECT_THAT(sut_.lost(), IsEmpty());
}

TEST_F(PeersTest, ASecondLifeSignOfAServiceKeepsItAlive) {
  all_live(sut_);
  join(sut_, 60, Peers::participant_name(kRig, "motion"));
  EXPECT_TRUE(sut_.set_alive(handle_of(60), true));
  sut_.set_alive(handle_of(number_of("motion")), false);
  EXPECT_TRUE(sut_.alive());
  EXPECT_THAT(sut_.lost(), IsEmpty());
}

TEST_F(PeersTest, TheProcessWithoutALifeSignIsNamed) {
  all_live(sut_);
  sut_.set_alive(handle_of(number_of("motion")), false);
  EXPECT_STREQ(sut_.why_not_alive(), "a process is missing: motion");
  sut_.set_alive(handle_of(number_of("motion")), true);
  sut_.set_alive(handle_of(number_of("display")), false);
  EXPECT_STREQ(sut_.why_not_alive(), "a process is missing: display");
  join(sut_, kReplay, "stillhand-replay/1", true);
  EXPECT_STREQ(sut_.why_not_alive(), "a replay is on the bus");
}

TEST_F(PeersTest, AServiceThatIsThereTwiceIsNamedAlsoIfItIsOneself) {
  all_live(sut_);
  EXPECT_THAT(sut_.duplicates(), IsEmpty());
  join(sut_, 60, Peers::participant_name(kRig, "rig"));
  join(sut_, 61, Peers::participant_name(kRig, "motion"));
  join(sut_, 62, Peers::participant_name(kRig + 1, "display"));
  EXPECT_THAT(sut_.duplicates(), ElementsAre("motion", "rig"));
  leave(sut_, 61);
  leave(sut_, 60);
  EXPECT_THAT(sut_.duplicates(), IsEmpty());
}

TEST_F(PeersTest, AnnouncedAgainAParticipantIsStillOne) {
  all_live(sut_);
  sut_.on_participant(participant(number_of("motion"), Peers::participant_name(kRig, "motion")));
  EXPECT_THAT(sut_.duplicates(), IsEmpty());
}

TEST_F(PeersTest, WhileAReplayIsThereNobodyCountsAsAlive) {
  all_live(sut_);
  join(sut_, kReplay, "stillhand-replay/1", true);
  EXPECT_TRUE(sut_.replay_present());
  EXPECT_FALSE(sut_.alive());
  leave(sut_, kReplay);
  EXPECT_FALSE(sut_.replay_present());
  EXPECT_TRUE(sut_.replay_seen());
  EXPECT_TRUE(sut_.alive());
}

// DDS announces a writer before its participant, and its last samples may come after its end.
TEST_F(PeersTest, AMarkedWritersSamplesAreRefusedForGood) {
  EXPECT_FALSE(sut_.refuses(handle_of(kReplay)));
  sut_.on_writer(
      writer(kReplay, 1, "stillhand/motor_command", "stillhand_msgs::MotorCommand", replay_mark()));
  EXPECT_TRUE(sut_.replay_present());
  EXPECT_TRUE(sut_.refuses(handle_of(kReplay, 1)));
  EXPECT_TRUE(sut_.refuses(handle_of(kReplay, 2)));  // any writer of that participant
  EXPECT_FALSE(sut_.refuses(handle_of(kReplay - 1)));
  leave(sut_, kReplay);
  EXPECT_TRUE(sut_.refuses(handle_of(kReplay)));
}

TEST_F(PeersTest, TheEndOfAMarkedWriterAloneMarksNobody) {
  sut_.on_writer(gone(writer(kReplay, 1, "t", "T", replay_mark())));
  EXPECT_FALSE(sut_.replay_seen());
}

TEST_F(PeersTest, AProcessThatAnswersReplaysIsAliveWithOneAndRefusesNone) {
  Peers sut("identification", kRig, true);
  all_live(sut);
  live(sut, "rig");
  EXPECT_FALSE(sut.alive());
  join(sut, kReplay, "stillhand-replay/1", true);
  EXPECT_TRUE(sut.alive());
  EXPECT_FALSE(sut.refuses(handle_of(kReplay)));
}

// On a secured bus a name or a mark is no proof: a stranger must not open the interlock.
TEST_F(PeersTest, OnASecuredBusOnlyAnAuthenticatedParticipantCounts) {
  Peers sut("rig", kRig, false, nullptr, true);
  all_live(sut);
  join(sut, kReplay, "stillhand-replay/1", true);
  join(sut, 60, Peers::participant_name(kRig, "rig"));
  EXPECT_FALSE(sut.replay_present());
  EXPECT_TRUE(sut.alive());
  EXPECT_THAT(sut.duplicates(), IsEmpty());
  ertps::ParticipantAuthenticationInfo refused;
  refused.guid = announced::guid_of(kReplay);
  sut.onParticipantAuthentication(nullptr, std::move(refused));
  EXPECT_FALSE(sut.replay_present());
  authenticate(sut, kReplay);
  authenticate(sut, 60);
  EXPECT_TRUE(sut.replay_present());
  EXPECT_FALSE(sut.alive());
  EXPECT_THAT(sut.duplicates(), ElementsAre("rig"));
  leave(sut, kReplay);
  join(sut, kReplay, "stillhand-replay/1", true);  // back, and not yet authenticated
  EXPECT_FALSE(sut.replay_present());
}

// Oracle: the set of live writers, from which the answers follow by their definition.
TEST_F(PeersTest, AnyOrderOfLifeSignsGivesTheSameAnswers) {
  std::mt19937 random(20261123);
  std::uniform_int_distribution<std::size_t> any(0, topics::kServices.size() - 1);
  std::set<std::string> live_now, ever;
  for (const std::string_view service : topics::kServices) {
    join(sut_, number_of(service), Peers::participant_name(kRig, std::string(service)));
  }
  int all_alive = 0;
  for (int turn = 0; turn < 2000; ++turn) {
    const std::string service(topics::kServices[any(random)]);
    const bool comes = random() % 8 != 0;
    EXPECT_EQ(sut_.set_alive(handle_of(number_of(service)), comes),
              comes != live_now.contains(service));
    if (comes) {
      live_now.insert(service);
      ever.insert(service);
    } else {
      live_now.erase(service);
    }
    std::vector<std::string> gone;
    std::ranges::set_difference(ever, live_now, std::back_inserter(gone));
    std::set<std::string> others = live_now;
    others.erase("rig");
    const bool alive = others.size() == topics::kServices.size() - 1;
    ASSERT_EQ(sut_.lost(), gone) << "turn " << turn;
    ASSERT_EQ(sut_.alive(), alive) << "turn " << turn;
    all_alive += alive ? 1 : 0;
  }
  EXPECT_GT(all_alive, 100);  // both answers did occur
  EXPECT_LT(all_alive, 1900);
}

}  // namespace
}  // namespace stillhand::runtime::peers_test
