// SPDX-License-Identifier: Apache-2.0
// Strangers next to a secured pair on loopback: they receive nothing, and nothing of theirs is
// received.  Participant numbers are not reused within a process, and discovery reaches those up to
// the maxInitialPeersRange of qos/profiles.xml: the 33rd participant of this program would not be
// discovered.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>

#include "fast_dds/names.hpp"
#include "places.hpp"
#include "services/bus/participant.hpp"
#include "services/bus/playback.hpp"
#include "services/bus/security.hpp"
#include "services/bus/type_tag.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/motion_and_rig.hpp"
#include "tests/support/security_folder.hpp"

namespace stillhand::runtime {
namespace {

using stillhand_msgs::MotorCommand;
using stillhand_msgs::PlatformCommand;
using support::eventually;
using support::MotionAndRig;
using support::reissue;
using support::SecurityFolders;
namespace fs = std::filesystem;

constexpr long kDay_s = 86400;
// Steps at which a stranger stays silent and deaf: a second and more, where the lab's own
// participants match within some tenths.
constexpr int kSteps = 500;

fs::path lab() { return SecurityFolders::get().lab(); }

bool refused(const Identity& identity) {
  try {
    check_identity(identity, 0);
  } catch (const ConfigError&) {
    return true;
  }
  return false;
}

/// Somebody who keeps to no rule of Stillhand: Fast DDS itself, with whatever files are at hand.
/// Reads platform commands and writes motor commands.
class Stranger : public edds::DataWriterListener {
 public:
  explicit Stranger(const Identity& identity) {
    load_profiles(STILLHAND_SOURCE "/qos/profiles.xml");
    auto* factory = edds::DomainParticipantFactory::get_instance();
    edds::DomainParticipantQos qos;
    factory->get_participant_qos_from_profile("stillhand_participant", qos);
    // Under a name of the session, which is anybody's to take.
    qos.name("stillhand/1/rig");
    if (!identity.none()) secure(qos, identity);
    participant_ = factory->create_participant(support::own_domain(), qos);
    if (participant_ == nullptr) throw std::runtime_error("Fast DDS refused the stranger itself");
    edds::Subscriber* subscriber = participant_->create_subscriber(edds::SUBSCRIBER_QOS_DEFAULT);
    reader_ = subscriber->create_datareader_with_profile(
        topic<PlatformCommand>(topics::kPlatformCommand), "control_loop");
    edds::Publisher* publisher = participant_->create_publisher(edds::PUBLISHER_QOS_DEFAULT);
    writer_ = publisher->create_datawriter_with_profile(topic<MotorCommand>(topics::kMotorCommand),
                                                        "control_loop", this);
  }
  ~Stranger() override {
    participant_->delete_contained_entities();
    edds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;

  [[nodiscard]] bool reads() const { return reader_ != nullptr; }
  [[nodiscard]] bool writes() const { return writer_ != nullptr; }
  void step() {
    MotorCommand command;
    command.rig(1);
    command.tick(++tick_);
    command.force_n(40.0);
    if (writes()) writer_->write(&command);
    PlatformCommand taken;
    edds::SampleInfo info;
    while (reads() && ok(reader_->take_next_sample(&taken, &info))) {
      if (info.valid_data) ++received_;
    }
  }
  [[nodiscard]] int received() const { return received_; }

 private:
  template <typename Message>
  edds::Topic* topic(const topics::Topic& row) {
    type_tag<Message>().support.register_type(participant_);
    return participant_->create_topic(std::string(row.name), std::string(row.type),
                                      edds::TOPIC_QOS_DEFAULT);
  }
  edds::DomainParticipant* participant_ = nullptr;
  edds::DataReader* reader_ = nullptr;
  edds::DataWriter* writer_ = nullptr;
  Tick tick_ = 0;
  int received_ = 0;
};

/// Nothing comes through, and the lab goes on.
void expect_shut_out(Stranger& stranger, MotionAndRig& lab_pair) {
  ASSERT_TRUE(stranger.reads() && stranger.writes());
  ASSERT_TRUE(lab_pair.exchange(kSteps, [&] { stranger.step(); }));
  EXPECT_EQ(stranger.received(), 0);
  EXPECT_EQ(lab_pair.motor_commands.load(), 0);
}

// That the stranger's silence below is the lab's doing: each half of the same program, let in.
TEST(StrangersTest, TheSameProgramIsHeardAndHearsWithoutSecurity) {
  Stranger stranger({});
  MotionAndRig unsecured("");
  EXPECT_TRUE(unsecured.exchange(1));
  EXPECT_TRUE(eventually([&] {
    unsecured.step();
    stranger.step();
    return stranger.received() > 0 && unsecured.motor_commands.load() > 0;
  }));
}

TEST(StrangersTest, TheSameProgramIsHeardWithTheCancellersCertificate) {
  Stranger canceller({lab(), "cancellation"});
  EXPECT_FALSE(canceller.reads());
  MotionAndRig secured(lab());
  EXPECT_TRUE(eventually([&] {
    canceller.step();
    return secured.motor_commands.load() > 0;
  }));
}

TEST(StrangersTest, TheSameProgramHearsWithTheRecordersCertificate) {
  Stranger recorder({lab(), "recorder"});
  EXPECT_FALSE(recorder.writes());
  MotionAndRig secured(lab());
  EXPECT_TRUE(eventually([&] {
    secured.step();
    recorder.step();
    return recorder.received() > 0;
  }));
}

TEST(StrangersTest, WithoutACertificateNothingIsHeardOrDelivered) {
  Stranger stranger({});
  MotionAndRig secured(lab());
  expect_shut_out(stranger, secured);
  // Nor does its name, the rig's, count.
  EXPECT_THAT(secured.rig.duplicate_peers(), testing::IsEmpty());
}

/// Alters a document of a folder by a sed script and signs it again, as `authority` does.
void rewrite(const fs::path& folder, const char* file, const std::string& script,
             const fs::path& authority) {
  SecurityFolders::shell(
      "cd " + folder.string() + " && openssl smime -verify -text -CAfile authority.pem -in " +
      file + " 2>log | sed '" + script + "' >altered.xml && openssl smime -sign -text -in " +
      "altered.xml -out " + file + " -signer " + (authority / "authority.pem").string() +
      " -inkey " + SecurityFolders::get().authority_key(authority).string());
}

TEST(StrangersTest, WithACertificateOfAnotherAuthorityNothingIsHeardOrDelivered) {
  const fs::path other = SecurityFolders::get().other();
  // It may write and read everything, by its own authority.
  rewrite(other, "rig/permissions.p7s", "s#<topic>[^<]*<#<topic>*<#", other);
  Stranger stranger({other, "rig"});
  MotionAndRig secured(lab());
  expect_shut_out(stranger, secured);
  // Nor does its name, the rig's, count.
  EXPECT_THAT(secured.rig.duplicate_peers(), testing::IsEmpty());
}

TEST(StrangersTest, WithAnExpiredCertificateNothingIsHeardOrDelivered) {
  // Fast DDS opens no participant with an expired certificate of its own: so it expires after.
  const fs::path folder = SecurityFolders::get().copy_of_lab("expiring");
  reissue(folder, "recorder", -kDay_s, 2);
  reissue(folder, "cancellation", -kDay_s, 2);
  Stranger reader({folder, "recorder"});
  Stranger writer({folder, "cancellation"});
  ASSERT_TRUE(eventually(
      [&] { return refused({folder, "recorder"}) && refused({folder, "cancellation"}); }));
  MotionAndRig secured(lab());
  ASSERT_TRUE(secured.exchange(kSteps, [&] {
    reader.step();
    writer.step();
  }));
  EXPECT_EQ(reader.received(), 0);
  EXPECT_EQ(secured.motor_commands.load(), 0);
}

TEST(StrangersTest, WithTheDisplaysCertificateAndRulesOfItsOwnNoOtherTopicIsHeardOrDelivered) {
  // A genuine certificate and genuine permissions, but a governance of its own that asks for no
  // permission, so that its own Fast DDS does not stop it: the lab's must.
  const fs::path folder = SecurityFolders::get().copy_of_lab("lawless");
  const fs::path own = folder.parent_path() / "own";
  SecurityFolders::make(own, "--lab own");
  rewrite(folder, "governance.p7s", "s/_access_control>true/_access_control>false/", own);
  SecurityFolders::shell("cat " + (own / "authority.pem").string() + " >>" +
                         (folder / "authority.pem").string());
  Stranger stranger({folder, "display"});
  MotionAndRig secured(lab());
  expect_shut_out(stranger, secured);
}

TEST(StrangersTest, AReplayWithoutACertificateOpensNoInterlock) {
  MotionAndRig secured(lab());
  MotionAndRig unsecured("");
  const Playback replay(STILLHAND_SOURCE "/qos/profiles.xml", support::own_domain(), "replay");
  ASSERT_TRUE(eventually([&] { return unsecured.rig.replay_present(); }));
  ASSERT_TRUE(secured.exchange(kSteps));
  EXPECT_FALSE(secured.rig.replay_present());
}

}  // namespace
}  // namespace stillhand::runtime
