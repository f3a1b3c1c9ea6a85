// SPDX-License-Identifier: Apache-2.0
// A secured bus on loopback, with the folders that deploy/security/make.sh makes: what is refused
// before the bus opens, and what a service may do.  Strangers: strangers_test.cpp.
#include "services/bus/security.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "fast_dds/names.hpp"
#include "idl/recording.h"
#include "idl/session.h"
#include "places.hpp"
#include "services/bus/participant.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/motion_and_rig.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/security_folder.hpp"

namespace stillhand::runtime {
namespace {

using stillhand_msgs::MotorCommand;
using stillhand_msgs::PlatformCommand;
using support::bus_options;
using support::reissue;
using support::SecurityFolders;
using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr long kDay_s = 86400;

std::string refusal(const Identity& identity, std::uint32_t domain = 0) {
  return support::refusal([&] { check_identity(identity, domain); });
}

fs::path lab() { return SecurityFolders::get().lab(); }
fs::path altered() { return SecurityFolders::get().copy_of_lab("altered"); }
void replace(const fs::path& from, const fs::path& to) {
  fs::copy_file(from, to, fs::copy_options::overwrite_existing);
}

TEST(CheckIdentityTest, AFolderAsItIsMadeIsGoodForEveryServiceDashboardAndTap) {
  for (const std::string_view service : topics::kServices) {
    EXPECT_EQ(refusal({lab(), std::string(service)}), "accepted");
    EXPECT_EQ(expiry_warning({lab(), std::string(service)}), "");
  }
  EXPECT_EQ(refusal({lab(), std::string(topics::kDashboard)}), "accepted");
  EXPECT_EQ(refusal({lab(), std::string(topics::kTap)}), "accepted");
}

// A machine holds the certificates of its own services alone, and knows whom to expect elsewhere.
TEST(CheckIdentityTest, TheGuidOfAnotherServiceFollowsFromOnesOwnCertificate) {
  std::set<std::array<std::uint8_t, 6>> all;
  for (const std::string_view service : topics::kServices) {
    const auto start = guid_start({lab(), std::string(service)});
    EXPECT_EQ(guid_start({lab(), "rig"}, std::string(service)), start) << service;
    all.insert(start);
  }
  EXPECT_EQ(all.size(), topics::kServices.size());
}

TEST(CheckIdentityTest, PrivateKeysAreTheOwnersAlone) {
  for (const auto& entry : fs::recursive_directory_iterator(lab())) {
    if (!entry.path().string().ends_with("key.pem")) continue;
    EXPECT_EQ(entry.status().permissions(), fs::perms::owner_read | fs::perms::owner_write)
        << entry.path();
  }
}

TEST(CheckIdentityTest, NamesAMissingFile) {
  for (const char* file : {"authority.pem", "governance.p7s", "rig/certificate.pem", "rig/key.pem",
                           "rig/permissions.p7s"}) {
    const fs::path folder = altered();
    fs::remove(folder / file);
    EXPECT_THAT(refusal({folder, "rig"}), HasSubstr((folder / file).string()));
  }
}

TEST(CheckIdentityTest, RefusesAnExpiredCertificate) {
  const fs::path folder = altered();
  reissue(folder, "rig", -2 * kDay_s, -kDay_s);
  EXPECT_THAT(refusal({folder, "rig"}),
              AllOf(HasSubstr("rig/certificate.pem"), HasSubstr("expired on")));
}

TEST(CheckIdentityTest, RefusesACertificateThatIsNotYetValid) {
  const fs::path folder = altered();
  reissue(folder, "rig", kDay_s, 2 * kDay_s);
  EXPECT_THAT(refusal({folder, "rig"}), HasSubstr("not valid before"));
}

TEST(CheckIdentityTest, WarnsThirtyDaysAhead) {
  const fs::path folder = altered();
  reissue(folder, "rig", 0, 29 * kDay_s);
  EXPECT_EQ(refusal({folder, "rig"}), "accepted");
  EXPECT_THAT(expiry_warning({folder, "rig"}), HasSubstr("rig/certificate.pem expires on"));
  reissue(folder, "rig", 0, 31 * kDay_s);
  EXPECT_EQ(expiry_warning({folder, "rig"}), "");
}

TEST(CheckIdentityTest, RefusesAnotherAuthoritysCertificate) {
  const fs::path folder = altered();
  replace(SecurityFolders::get().other() / "rig/certificate.pem", folder / "rig/certificate.pem");
  EXPECT_THAT(refusal({folder, "rig"}), HasSubstr("a certificate of the authority in"));
}

TEST(CheckIdentityTest, RefusesAnothersKey) {
  const fs::path folder = altered();
  replace(folder / "motion/key.pem", folder / "rig/key.pem");
  EXPECT_THAT(refusal({folder, "rig"}), HasSubstr("the key of another certificate"));
}

TEST(CheckIdentityTest, RefusesDocumentsThatTheAuthorityDidNotSign) {
  for (const char* file : {"governance.p7s", "rig/permissions.p7s"}) {
    const fs::path folder = altered();
    replace(SecurityFolders::get().other() / file, folder / file);
    EXPECT_THAT(refusal({folder, "rig"}), AllOf(HasSubstr(file), HasSubstr("signed by")));
  }
}

TEST(CheckIdentityTest, RefusesDocumentsThatWereAlteredAfterSigning) {
  const fs::path folder = altered();
  SecurityFolders::shell("sed -i 's/<default>DENY/<default>ALLOW/' " +
                         (folder / "rig/permissions.p7s").string());
  EXPECT_THAT(refusal({folder, "rig"}), HasSubstr("rig/permissions.p7s"));
}

TEST(CheckIdentityTest, RefusesAnothersPermissions) {
  const fs::path folder = altered();
  replace(folder / "cancellation/permissions.p7s", folder / "rig/permissions.p7s");
  EXPECT_THAT(refusal({folder, "rig"}), HasSubstr("those of \"CN=rig,O=stillhand\""));
}

TEST(CheckIdentityTest, RefusesADomainThatTheFolderIsNotMadeFor) {
  const fs::path folder = altered().parent_path() / "one-domain";
  SecurityFolders::make(folder, "--domain 7");
  EXPECT_EQ(refusal({folder, "rig"}, 7), "accepted");
  EXPECT_THAT(refusal({folder, "rig"}, 8), HasSubstr("domain: got 8, want 7 to 7"));
}

TEST(CheckIdentityTest, RefusesAKeyThatEverybodyMayRead) {
  const fs::path folder = altered();
  fs::permissions(folder / "rig/key.pem", fs::perms::group_read, fs::perm_options::add);
  EXPECT_EQ(refusal({folder, "rig"}), "accepted");
  fs::permissions(folder / "rig/key.pem", fs::perms::others_read, fs::perm_options::add);
  EXPECT_THAT(refusal({folder, "rig"}), AllOf(HasSubstr("rig/key.pem"), HasSubstr("chmod o=")));
}

TEST(IdentityTest, IsThatOfTheServiceOfADashboardOrElseTheTap) {
  EXPECT_EQ(Identity::of(lab(), "rig").name, "rig");
  EXPECT_EQ(Identity::of(lab(), "dashboard-17").name, "dashboard");
  EXPECT_EQ(Identity::of(lab(), "record-17").name, "tap");
}

using Builtin = ertps::BuiltinAttributes;

/// What secure() says of a participant with this transport, multicast as the standard has it but
/// for what `change` says.
std::string refused_discovery(
    const std::vector<std::string>& addresses, bool shared_memory,
    const std::function<void(Builtin&)>& change = [](Builtin&) {}) {
  const auto udp = std::make_shared<ertps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = addresses;
  edds::DomainParticipantQos qos;
  qos.transport().use_builtin_transports = shared_memory;
  qos.transport().user_transports.push_back(udp);
  change(qos.wire_protocol().builtin);
  return support::refusal([&] { secure(qos, {lab(), "rig"}); });
}

TEST(SecurityTest, DiscoveryByMulticastOnTheNetworkIsRefused) {
  EXPECT_EQ(refused_discovery({"127.0.0.1"}, false), "accepted");
  EXPECT_THAT(refused_discovery({"192.0.2.1"}, false), HasSubstr("multicast"));
  EXPECT_THAT(refused_discovery({}, false), HasSubstr("multicast"));
}

// As in a profile with metatrafficMulticastLocatorList: two threads, whatever else the profile has.
TEST(SecurityTest, AGroupBesideUnicastIsRefusedAndUnicastAloneIsNot) {
  const auto unicast = [](Builtin& builtin) {
    builtin.metatrafficUnicastLocatorList.push_back(ertps::Locator_t());
  };
  const auto group = [](Builtin& builtin) {
    ertps::Locator_t locator;
    ertps::IPLocator::setIPv4(locator, "239.255.0.1");
    builtin.metatrafficMulticastLocatorList.push_back(locator);
  };
  EXPECT_EQ(refused_discovery({"192.0.2.1"}, false, unicast), "accepted");
  EXPECT_THAT(refused_discovery({"127.0.0.1"}, false, group), HasSubstr("multicast"));
  for (const char* address : {"192.0.2.1", "127.0.0.1"}) {
    EXPECT_THAT(refused_discovery({address}, false,
                                  [&](Builtin& builtin) {
                                    unicast(builtin);
                                    group(builtin);
                                  }),
                HasSubstr("multicast"));
  }
}

TEST(SecurityTest, SeveralWaysToBeHeardAreRefused) {
  EXPECT_THAT(refused_discovery({"127.0.0.1", "192.0.2.1"}, false),
              HasSubstr("several transports"));
  EXPECT_THAT(refused_discovery({"127.0.0.1"}, true), HasSubstr("several transports"));
}

TEST(SecurityTest, ADiscoveryServerIsRefused) {
  ASSERT_EQ(setenv("ROS_DISCOVERY_SERVER", "127.0.0.1:11811", 1), 0);
  EXPECT_THROW(Bus(bus_options("rig", lab())), ConfigError);
  unsetenv("ROS_DISCOVERY_SERVER");
}

std::string refused_at_start(Bus& bus) {
  return support::refusal<BusError>([&] { bus.start(); });
}

TEST(SecurityTest, AServiceMayWriteAndReadNothingButItsOwnTopics) {
  Bus own(bus_options("display", lab()));
  own.publisher<stillhand_msgs::TrackingSample>(topics::kTrackingSample);
  EXPECT_EQ(refused_at_start(own), "accepted");
  Bus writer(bus_options("display", lab()));
  writer.publisher<MotorCommand>(topics::kMotorCommand);
  EXPECT_THAT(refused_at_start(writer), HasSubstr("display write stillhand/motor_command"));
  Bus reader(bus_options("display", lab()));
  reader.subscribe<PlatformCommand>(topics::kPlatformCommand, [](const auto&, const auto&) {});
  EXPECT_THAT(refused_at_start(reader), HasSubstr("display read stillhand/platform_command"));
}

TEST(SecurityTest, ADashboardMayAskAndReadButSteerNothing) {
  Bus own(bus_options("dashboard-1", lab()));
  own.publisher<stillhand_msgs::SessionCommand>(topics::kSessionCommand);
  own.publisher<stillhand_msgs::RecorderCommand>(topics::kRecorderCommand);
  own.subscribe<stillhand_msgs::RecorderStatus>(topics::kRecorderStatus,
                                                [](const auto&, const auto&) {});
  own.subscribe<PlatformCommand>(topics::kPlatformCommand, [](const auto&, const auto&) {});
  EXPECT_EQ(refused_at_start(own), "accepted");
  Bus writer(bus_options("dashboard-1", lab()));
  writer.publisher<stillhand_msgs::TrialControl>(topics::kTrialControl);
  EXPECT_THAT(refused_at_start(writer), HasSubstr("write stillhand/trial_control"));
  Bus tap(bus_options("record-1", lab()));
  tap.publisher<stillhand_msgs::SessionCommand>(topics::kSessionCommand);
  EXPECT_THAT(refused_at_start(tap), HasSubstr("write stillhand/session_command"));
}

TEST(SecurityTest, OnlyAParticipantWithThatCertificateCountsAsSecured) {
  edds::DomainParticipant* const plain = create_participant(
      STILLHAND_SOURCE "/qos/profiles.xml", support::own_domain(), "plain", false, {}, nullptr);
  edds::DomainParticipant* const rig =
      create_participant(STILLHAND_SOURCE "/qos/profiles.xml", support::own_domain(), "rig", false,
                         {lab(), "rig"}, nullptr);
  EXPECT_FALSE(is_secured(*plain, {lab(), "rig"}));
  EXPECT_TRUE(is_secured(*rig, {lab(), "rig"}));
  EXPECT_FALSE(is_secured(*rig, {lab(), "motion"}));
  edds::DomainParticipantFactory::get_instance()->delete_participant(plain);
  edds::DomainParticipantFactory::get_instance()->delete_participant(rig);
}

}  // namespace
}  // namespace stillhand::runtime
