// SPDX-License-Identifier: Apache-2.0
// Another DDS on our bus, tests/interface/cyclone/peer.c: it reads and writes our topics, and is
// shut out from a secured bus.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "places.hpp"
#include "tests/support/child.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/motion_and_rig.hpp"
#include "tests/support/security_folder.hpp"

namespace stillhand::runtime {
namespace {

using support::eventually;
using support::MotionAndRig;
using testing::HasSubstr;

constexpr const char* kPeer = STILLHAND_BUILD "/tests/cyclone_peer";

class CycloneTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_regular_file(kPeer)) {
      GTEST_SKIP() << "skipped: built without Cyclone DDS (packages cyclonedds-dev and "
                      "cyclonedds-tools)";
    }
  }
  std::unique_ptr<support::Child> peer() {
    // As our profiles: loopback alone, and its multicast for discovery; on a secured bus, which
    // hears no multicast, it knocks at the doors of the first participants.
    return std::make_unique<support::Child>(
        std::vector<std::string>{kPeer, std::to_string(support::own_domain())}, folder_ / "output",
        std::vector<std::string>{
            "CYCLONEDDS_URI=<CycloneDDS><Domain><General><Interfaces>"
            "<NetworkInterface address='127.0.0.1' multicast='true'/></Interfaces>"
            "</General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
            "<MaxAutoParticipantIndex>31</MaxAutoParticipantIndex>"
            "<Peers><Peer Address='127.0.0.1'/></Peers></Discovery></Domain></CycloneDDS>"});
  }

 private:
  const support::Folder folder_;
};

TEST_F(CycloneTest, ReadsAndWritesOurTopicsValueByValue) {
  MotionAndRig unsecured("");
  unsecured.command.position_m(0.125);
  unsecured.command.velocity_m_s(-0.5);
  unsecured.command.acceleration_m_s2(9.75);
  unsecured.command.trial(-1);
  unsecured.command.flags(2147483649u);
  const auto sut = peer();
  ASSERT_TRUE(eventually([&] {
    unsecured.step();
    return unsecured.motor_commands.load() > 0 && sut->output().find("first") != std::string::npos;
  })) << sut->output();
  // Rig and what changes with each sample first.
  EXPECT_THAT(sut->output(), HasSubstr(" 0.125 -0.5 9.75 -1 2147483649\n"));
  EXPECT_THAT(sut->output(), HasSubstr("first 1 "));
  const auto& got = unsecured.first_motor_command;
  EXPECT_EQ(got.rig(), 1u);
  EXPECT_EQ(got.tick(), 7);
  EXPECT_EQ(got.stamp_ns(), 8);
  EXPECT_EQ(got.acquired_ns(), 9);
  EXPECT_EQ(got.force_n(), -1.5);
  EXPECT_EQ(got.predicted_force_n(), 2.25);
  EXPECT_EQ(got.gain_weight(), 0.5);
  EXPECT_EQ(got.phase_weight(), 0.125);
  EXPECT_EQ(got.model(), 4);
  EXPECT_TRUE(got.enabled());
  EXPECT_FALSE(got.permitted());
  EXPECT_EQ(got.flags(), 6u);
  EXPECT_EQ(sut->finish(), 0);
}

TEST_F(CycloneTest, HearsAndDeliversNothingOnASecuredBus) {
  const auto sut = peer();
  ASSERT_TRUE(eventually([&] { return sut->output().find("running") != std::string::npos; }));
  MotionAndRig secured(support::SecurityFolders::get().lab());
  // A second and more, where it takes some tenths without security.
  ASSERT_TRUE(secured.exchange(500));
  EXPECT_EQ(secured.motor_commands.load(), 0);
  EXPECT_EQ(sut->finish(), 0);
  EXPECT_THAT(sut->output(), HasSubstr("received 0 written "));
}

}  // namespace
}  // namespace stillhand::runtime
