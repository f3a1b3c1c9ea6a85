// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/hosts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/deploy/machine.hpp"
#include "apps/lab/lab_options.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/deploy/sample_inventory.hpp"

namespace stillhand::lab::hosts_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// An address of this machine at which others reach it; without a network, one of nobody.
std::string own_address() {
  for (const std::string& address : deploy::own_addresses()) {
    if (!address.starts_with("127.")) return address;
  }
  return "10.0.0.1";
}

/// Whether there is one: a machine without a network is refused as the host of the experiment.
bool on_a_network() { return own_address() != "10.0.0.1"; }

/// This machine, with the experiment, and a rig-pc with the services named.
std::string two_hosts(const std::string& there, const std::string& here,
                      const std::string& address = own_address(), const std::string& start = "") {
  return "lab: bench\ndomain: 7\nhosts:\n  - {name: desk, address: " + address + start +
         ", services: [" + here + "]}\n  - {name: rig-pc, address: 10.0.0.2, " +
         "start: [ssh, rig-pc], services: [" + there + "]}\nsecurity: none\n";
}

class HostsTest : public testing::Test {
 protected:
  HostsTest() {
    options_.domain = 3;
    options_.rig = 1;
    options_.profiles = "/profiles.xml";
    options_.config = "/config";
    options_.out = "/out";
  }
  void inventory(const std::string& text) { options_.inventory = folder_.file(text); }
  [[nodiscard]] std::string refusal() const {
    return support::refusal([&] { const Hosts sut(options_); });
  }

  const std::string screen_here_ = deploy::all_but({"motion", "rig", "sensing"});
  deploy::SampleFolder folder_;
  LabOptions options_;
};

TEST_F(HostsTest, WithoutAnInventoryEverythingIsOfThisMachine) {
  const Hosts sut(options_);
  EXPECT_EQ(sut.domain(), 3u);
  const Place place = sut.of("rig");
  EXPECT_EQ(place.profiles, "/profiles.xml");
  EXPECT_EQ(place.config, "/config");
  EXPECT_EQ(place.out, "/out");
  EXPECT_TRUE(place.security.empty());
  Launch launch;
  launch.name = "rig";
  launch.executable = "/bin/stillhand-rig";
  EXPECT_EQ(sut.placed(launch).executable, launch.executable);
}

TEST_F(HostsTest, TheInventoryNamesTheDomain) {
  if (!on_a_network()) return;
  inventory(two_hosts("motion, rig, sensing", screen_here_));
  ASSERT_EQ(refusal(), "accepted");
  EXPECT_EQ(Hosts(options_).domain(), 7u);
}

TEST_F(HostsTest, ARigThatTheInventoryLacksIsRefused) {
  inventory(two_hosts("motion, rig, sensing", screen_here_));
  options_.rig = 2;
  EXPECT_THAT(refusal(), AllOf(StartsWith("--rig: got 2"), HasSubstr("inventory.yaml")));
}

TEST_F(HostsTest, AnExperimentThatIsReachedByStartWordsIsNotHere) {
  inventory(two_hosts("motion, rig, sensing", screen_here_, "10.0.0.1", ", start: [ssh, desk]"));
  EXPECT_THAT(refusal(), AllOf(HasSubstr("inventory.yaml:4:"), HasSubstr("host desk"),
                               HasSubstr("experiment"), HasSubstr("start")));
}

// 203.0.113.0/24 is for documentation: no interface has one of its addresses.
TEST_F(HostsTest, AnExperimentOfAnotherAddressIsNotHere) {
  inventory(two_hosts("motion, rig, sensing", screen_here_, "203.0.113.77"));
  EXPECT_THAT(refusal(), AllOf(HasSubstr("inventory.yaml:4:"), HasSubstr("host desk"),
                               HasSubstr("203.0.113.77")));
}

TEST_F(HostsTest, ASealedEffectDoesNotTravelOverANetwork) {
  if (!on_a_network()) return;
  options_.undeclared_effect = 42;
  inventory(two_hosts("motion, rig, sensing", screen_here_));
  EXPECT_THAT(refusal(), AllOf(StartsWith("--undeclared-effect: "), HasSubstr("rig-pc")));
  inventory(two_hosts("motion, sensing", "rig, " + screen_here_));
  EXPECT_EQ(refusal(), "accepted");
}

TEST_F(HostsTest, ARideIsAFileOfThisMachine) {
  if (!on_a_network()) return;
  options_.ride = "ride.csv";
  inventory(two_hosts("motion, rig, sensing", screen_here_));
  EXPECT_THAT(refusal(), AllOf(StartsWith("--ride: "), HasSubstr("motion"), HasSubstr("rig-pc")));
  inventory(two_hosts("rig, sensing", "motion, " + screen_here_));
  EXPECT_EQ(refusal(), "accepted");
}

TEST_F(HostsTest, AMouseNeedsDisplayAndOperatorOnOneHost) {
  if (!on_a_network()) return;
  options_.who = Operator::kMouse;
  inventory(two_hosts("motion, rig, sensing", screen_here_));
  EXPECT_EQ(refusal(), "accepted");
  inventory(two_hosts("motion, rig, sensing, display",
                      deploy::all_but({"motion", "rig", "sensing", "display"})));
  EXPECT_THAT(refusal(),
              AllOf(StartsWith("--operator: "), HasSubstr("display"), HasSubstr("human_operator")));
  inventory(two_hosts("motion, rig, sensing, display, human_operator",
                      deploy::all_but({"motion", "rig", "sensing", "display", "human_operator"})));
  EXPECT_EQ(refusal(), "accepted");
}

TEST_F(HostsTest, AnInventoryThatIsMissingOrWrongIsNamed) {
  options_.inventory = "/no/such/lab.yaml";
  EXPECT_THAT(refusal(), HasSubstr("/no/such/lab.yaml"));
  inventory(two_hosts("motion, sensing", screen_here_));  // nobody has the rig
  EXPECT_THAT(refusal(), AllOf(HasSubstr("inventory.yaml"), HasSubstr("rig")));
}

}  // namespace
}  // namespace stillhand::lab::hosts_test
