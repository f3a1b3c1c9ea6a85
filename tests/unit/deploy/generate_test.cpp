// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/generate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <thread>

#include "apps/deploy/host_files.hpp"
#include "places.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/system/process/real_time.hpp"
#include "tests/support/folder.hpp"
#include "tests/unit/deploy/sample_inventory.hpp"

namespace stillhand::deploy::generate_test {
namespace {

using support::text_of;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

namespace fs = std::filesystem;

const LabProfiles& profiles() {
  static const LabProfiles loaded(STILLHAND_SOURCE "/qos/profiles.xml");
  return loaded;
}

Inventory example() { return read_inventory(STILLHAND_SOURCE "/deploy/inventory.example.yaml"); }

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

/// A unit's settings; of a key that stands several times the values, one a line.
std::map<std::string, std::string> settings_of(const std::string& unit) {
  std::map<std::string, std::string> settings;
  std::istringstream lines(unit);
  for (std::string line; std::getline(lines, line);) {
    const auto equals = line.find('=');
    if (line.empty() || line.front() == '#' || equals == std::string::npos) continue;
    std::string& value = settings[line.substr(0, equals)];
    value += (value.empty() ? "" : "\n") + line.substr(equals + 1);
  }
  return settings;
}

std::map<std::string, std::string> unit_named(const Inventory& inventory, const std::string& host,
                                              const std::string& name) {
  for (const GeneratedFile& unit : units_of(inventory, *inventory.find_host(host))) {
    if (unit.name == name) return settings_of(unit.text);
  }
  ADD_FAILURE() << "no " << name;
  return {};
}

TEST(GenerateTest, EveryHostHasAFolderWithWhatItRuns) {
  const SampleFolder folder;
  EXPECT_THAT(generate(example(), profiles(), folder.path() / "made"), IsEmpty());
  EXPECT_THAT(names_in(folder.path() / "made"),
              UnorderedElementsAre("rig-pc", "screen-pc", "desk"));
  EXPECT_THAT(
      names_in(folder.path() / "made" / "rig-pc"),
      UnorderedElementsAre("profiles.xml", "firewall.nft", "sysctl.conf", "stillhand.target",
                           "stillhand-rig@1.service", "stillhand-sensing@1.service",
                           "stillhand-motion@1.service", "stillhand-cancellation@1.service"));
}

TEST(GenerateTest, TheExperimentHasNoUnitSinceAPersonStartsIt) {
  const SampleFolder folder;
  generate(example(), profiles(), folder.path());
  EXPECT_THAT(names_in(folder.path() / "desk"), AllOf(Contains("stillhand-recorder@1.service"),
                                                      Not(Contains(HasSubstr("experiment")))));
}

// The clock alone may name one twice, and a recorder that is refused a file stays down.
TEST(GenerateTest, EachStartOfTheRecorderHasAFileOfItsOwn) {
  const SampleFolder folder;
  generate(example(), profiles(), folder.path());
  EXPECT_THAT(text_of(folder.path() / "desk" / "stillhand-recorder@1.service"),
              HasSubstr("_$$INVOCATION_ID.mcap"));
}

TEST(GenerateTest, TheSameInventoryGivesTheSameFiles) {
  const SampleFolder folder;
  generate(example(), profiles(), folder.path() / "one");
  generate(example(), profiles(), folder.path() / "two");
  for (const std::string host : {"rig-pc", "screen-pc", "desk"}) {
    const auto names = names_in(folder.path() / "one" / host);
    ASSERT_EQ(names, names_in(folder.path() / "two" / host));
    for (const std::string& name : names) {
      const std::string text = text_of(folder.path() / "one" / host / name);
      EXPECT_EQ(text, text_of(folder.path() / "two" / host / name)) << name;
      EXPECT_THAT(text, HasSubstr("from inventory.example.yaml for host " + host)) << name;
    }
  }
}

TEST(GenerateTest, AServiceThatMovedLeavesNoUnitBehindAndOtherFilesStay) {
  const SampleFolder folder;
  Inventory inventory = example();
  generate(inventory, profiles(), folder.path());
  std::ofstream(folder.path() / "desk" / "notes.txt") << "mine";
  auto& services = inventory.hosts[2].services;
  inventory.hosts[1].services.push_back(services.front());
  services.erase(services.begin());  // identification
  generate(inventory, profiles(), folder.path());
  EXPECT_THAT(names_in(folder.path() / "desk"),
              AllOf(Not(Contains("stillhand-identification@1.service")), Contains("notes.txt")));
  EXPECT_THAT(names_in(folder.path() / "screen-pc"),
              Contains("stillhand-identification@1.service"));
}

TEST(GenerateTest, AFolderOfAHostThatIsGoneIsNamed) {
  const SampleFolder folder;
  Inventory inventory = example();
  generate(inventory, profiles(), folder.path());
  inventory.hosts.pop_back();
  EXPECT_THAT(generate(inventory, profiles(), folder.path()), ElementsAre(folder.path() / "desk"));
}

TEST(GenerateTest, WhereOneHostCannotBeWrittenNothingIs) {
  const SampleFolder folder;
  const fs::path made = folder.path() / "made";
  fs::create_directory(made);
  std::ofstream(made / "desk") << "a file where the last folder is to be";
  EXPECT_THROW(generate(example(), profiles(), made), ConfigError);
  EXPECT_THAT(names_in(made), ElementsAre("desk"));
}

TEST(UnitsTest, AProcessIsToldItsLabAndRig) {
  const Inventory inventory = sample_inventory(two_rigs());
  auto sut = unit_named(inventory, "two", "stillhand-sensing@right.service");
  EXPECT_THAT(sut["ExecStart"], AllOf(HasSubstr("/bin/stillhand-sensing --domain 3 --rig 7 "),
                                      HasSubstr("--profiles /etc/stillhand/pair/profiles.xml"),
                                      HasSubstr("--real-time"), Not(HasSubstr("--security"))));
  EXPECT_THAT(sut["Description"], HasSubstr("sensing of rig right, lab pair"));
}

TEST(UnitsTest, KeysAreGivenWhereThereAreSome) {
  Inventory inventory = example();
  inventory.security = "hall-3-keys";
  EXPECT_THAT(unit_named(inventory, "rig-pc", "stillhand-rig@1.service")["ExecStart"],
              HasSubstr("--security /etc/stillhand/hall-3/security"));
}

// The process asks for the priority itself, too: both must be the same, and the limit must let it.
TEST(UnitsTest, ThePriorityIsWhatAProcessAsksFor) {
  auto sut = unit_named(example(), "rig-pc", "stillhand-rig@1.service");
  EXPECT_EQ(sut["CPUSchedulingPolicy"], "fifo");
  EXPECT_EQ(sut["LimitRTPRIO"], sut["CPUSchedulingPriority"]);
  EXPECT_EQ(sut["LimitMEMLOCK"], "infinity");
  bool granted = false;
  sched_param parameter{};
  std::thread([&] {
    granted = runtime::become_real_time();
    sched_getparam(0, &parameter);
  }).join();
  if (!granted) GTEST_SKIP() << "no right to SCHED_FIFO here";
  EXPECT_EQ(sut["CPUSchedulingPriority"], std::to_string(parameter.sched_priority));
}

TEST(UnitsTest, AProcessThatDiesComesBackButOneThatRefusesItsSettingsDoesNot) {
  auto sut = unit_named(example(), "rig-pc", "stillhand-rig@1.service");
  EXPECT_EQ(sut["Restart"], "always");
  EXPECT_EQ(sut["RestartPreventExitStatus"], "2");
  EXPECT_EQ(sut["WatchdogSec"], "2");
  EXPECT_EQ(sut["NotifyAccess"], "main");
}

TEST(UnitsTest, TheTargetWantsEveryUnitOfTheHost) {
  const Inventory inventory = example();
  EXPECT_EQ(unit_named(inventory, "screen-pc", "stillhand.target")["Wants"],
            "stillhand-display@1.service\nstillhand-human_operator@1.service");
}

TEST(UnitsTest, ADiscoveryServerRunsOnTheFirstHostAlone) {
  Inventory inventory = example();
  inventory.discovery = Discovery::kServer;
  EXPECT_THAT(unit_named(inventory, "rig-pc", "stillhand-discovery.service")["ExecStart"],
              HasSubstr("/etc/stillhand/hall-3/discovery_server.xml"));
  EXPECT_THAT(unit_named(inventory, "desk", "stillhand.target")["Wants"],
              Not(HasSubstr("discovery")));
}

TEST(UnitsTest, AProgramInAHomeCanBeReached) {
  Inventory inventory = example();
  EXPECT_EQ(unit_named(inventory, "rig-pc", "stillhand-rig@1.service")["ProtectHome"], "yes");
  inventory.hosts[0].prefix = "/home/lab/stillhand";
  EXPECT_EQ(unit_named(inventory, "rig-pc", "stillhand-rig@1.service")["ProtectHome"], "read-only");
}

Inventory with_devices() {
  Inventory inventory = example();
  inventory.rigs[0].devices = true;
  return inventory;
}

TEST(UnitsTest, ARigOfDevicesIsItsOwnProcessWithItsPortsAlone) {
  auto sut = unit_named(with_devices(), "rig-pc", "stillhand-device_rig@1.service");
  EXPECT_THAT(sut["ExecStart"], HasSubstr("/bin/stillhand-device_rig --domain 12 --rig 1 "));
  EXPECT_THAT(sut["After"], HasSubstr("iiod.service"));
  EXPECT_EQ(sut["DevicePolicy"], "closed");
  EXPECT_THAT(sut["DeviceAllow"], HasSubstr("char-ttyACM rw\nchar-ttyUSB rw"));
  EXPECT_EQ(sut["SupplementaryGroups"], "dialout");
  EXPECT_THAT(sut["RestrictAddressFamilies"], HasSubstr("AF_CAN"));
  EXPECT_EQ(sut["LimitRTPRIO"], sut["CPUSchedulingPriority"]);
  auto other = unit_named(with_devices(), "rig-pc", "stillhand-sensing@1.service");
  EXPECT_EQ(other.count("DevicePolicy"), 0u);
  EXPECT_THAT(other["RestrictAddressFamilies"], Not(HasSubstr("AF_CAN")));
}

// systemd's own judge reads every unit of the host.
TEST(UnitsTest, SystemdFindsNothingWrongWithTheUnits) {
  if (!fs::exists("/usr/bin/systemd-analyze")) GTEST_SKIP() << "no systemd-analyze here";
  const SampleFolder folder;
  Inventory inventory = with_devices();
  inventory.hosts[0].prefix = folder.path();
  fs::create_directory(folder.path() / "bin");
  std::string units;
  for (const GeneratedFile& unit : units_of(inventory, inventory.hosts[0])) {
    std::ofstream(folder.path() / unit.name) << unit.text;
    units += ' ' + (folder.path() / unit.name).string();
  }
  for (const char* program : {"device_rig", "sensing", "motion", "cancellation"}) {
    fs::create_symlink("/bin/true", folder.path() / "bin" / (std::string("stillhand-") + program));
  }
  const fs::path said = folder.path() / "said";
  const std::string command =
      "systemd-analyze --man=no verify" + units + " > " + said.string() + " 2>&1";
  const int status = std::system(command.c_str());
  // The man page is not installed next to a build; a warning of another unit is not ours.
  EXPECT_EQ(status, 0) << text_of(said);
  EXPECT_THAT(text_of(said), Not(HasSubstr("stillhand-device_rig"))) << text_of(said);
}

TEST(HostFilesTest, UdevGetsRulesWhereARigOfDevicesRuns) {
  const Inventory inventory = with_devices();
  const auto sut = device_rules_of(inventory, inventory.hosts[0]);
  ASSERT_TRUE(sut);
  EXPECT_THAT(sut->text, HasSubstr("SYMLINK+=\"fdcanusb\""));
  EXPECT_THAT(sut->text, HasSubstr("ATTR{latency_timer}=\"1\""));
  EXPECT_FALSE(device_rules_of(inventory, inventory.hosts[1]));
  EXPECT_FALSE(device_rules_of(example(), example().hosts[0]));
}

TEST(HostFilesTest, IiodHasThePriorityOfTheLoopWhereARigOfDevicesRuns) {
  const Inventory inventory = with_devices();
  const auto sut = iiod_priority_of(inventory, inventory.hosts[0]);
  ASSERT_TRUE(sut);
  auto rig = unit_named(inventory, "rig-pc", "stillhand-device_rig@1.service");
  EXPECT_THAT(sut->text,
              HasSubstr("[Service]\nCPUSchedulingPolicy=" + rig["CPUSchedulingPolicy"] +
                        "\nCPUSchedulingPriority=" + rig["CPUSchedulingPriority"] + "\n"));
  EXPECT_FALSE(iiod_priority_of(inventory, inventory.hosts[1]));
  EXPECT_FALSE(iiod_priority_of(example(), example().hosts[0]));
  const auto files = files_of(inventory, inventory.hosts[0], profiles());
  EXPECT_EQ(std::ranges::count(files, "iiod.conf", &GeneratedFile::name), 1);
}

TEST(HostFilesTest, TheFirewallLetsTheLabsHostsToItsPortsAlone) {
  const Inventory inventory = example();
  const std::string sut = firewall_of(inventory, inventory.hosts[0]).text;
  // Domain 12, 16 participants: 7400 + 3000, to + 11 + 2 15.
  EXPECT_THAT(sut, HasSubstr("udp dport 10400-10441 ip saddr != { 127.0.0.0/8, 192.168.7.1, "
                             "192.168.7.2, 192.168.7.3 } drop"));
  EXPECT_THAT(sut, HasSubstr("table inet stillhand_hall_3 {"));
}

TEST(HostFilesTest, TheKernelHasRoomForTheProfilesBuffers) {
  const Inventory inventory = example();
  const std::string sut = sysctl_of(inventory, inventory.hosts[0], {1000, 5000}).text;
  EXPECT_THAT(
      sut, AllOf(HasSubstr("net.core.rmem_max = 5000\n"), HasSubstr("net.core.wmem_max = 1000\n"),
                 HasSubstr("net.ipv4.ip_local_reserved_ports = 10400-10441\n")));
}

TEST(GenerateTest, AFolderInTheWayOfOneHostLeavesTheOthersToo) {
  const SampleFolder folder;
  const fs::path& out = folder.path();
  const Inventory inventory = example();
  fs::create_directories(out / inventory.hosts.back().name / "profiles.xml");
  EXPECT_THROW(generate(inventory, profiles(), out), ConfigError);
  EXPECT_EQ(names_in(out), std::set<std::string>{inventory.hosts.back().name});
}

TEST(GenerateTest, ANameWithDashesEndsNoXmlComment) {
  Inventory inventory = example();
  inventory.lab = "a---b--";
  const std::string text = profiles().of(inventory, inventory.hosts.front());
  const auto mark = text.find(kGeneratedMark);
  ASSERT_NE(mark, std::string::npos);
  const auto end = text.find("-->", mark);
  EXPECT_EQ(text.substr(mark, end - mark).find("--"), std::string::npos);
  EXPECT_THAT(text.substr(mark, end - mark), HasSubstr("a- - -b- -"));
}

}  // namespace
}  // namespace stillhand::deploy::generate_test
