// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/inventory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "places.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/deploy/sample_inventory.hpp"

namespace stillhand::deploy::inventory_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

TEST(InventoryTest, TheExampleIsALabOfThreeMachines) {
  const Inventory sut = read_inventory(STILLHAND_SOURCE "/deploy/inventory.example.yaml");
  EXPECT_EQ(sut.lab, "hall-3");
  EXPECT_EQ(sut.domain, 12U);
  EXPECT_EQ(sut.discovery, Discovery::kPeers);
  EXPECT_EQ(sut.security, "");
  ASSERT_EQ(sut.hosts.size(), 3U);
  EXPECT_EQ(sut.hosts[0].address, "192.168.7.1");
  EXPECT_THAT(sut.hosts[0].start, ElementsAre("ssh", "rig-pc"));
  EXPECT_EQ(sut.hosts[0].prefix, "/usr");
  EXPECT_THAT(sut.hosts[2].start, IsEmpty());
  EXPECT_EQ(sut.host_of("display", 1).name, "screen-pc");
  EXPECT_EQ(sut.host_of("experiment", 1).name, "desk");
  EXPECT_EQ(sut.find_host("desk"), &sut.hosts[2]);
  EXPECT_EQ(sut.find_host("elsewhere"), nullptr);
  EXPECT_EQ(sut.rig(1).name, "1");
}

TEST(InventoryTest, WhatIsLeftOutHasItsDefault) {
  const Inventory sut = sample_inventory(R"(
lab: bench
hosts: [{name: pc, address: 127.0.0.1, services: [)" +
                                         kAllServices + "]}]");
  EXPECT_EQ(sut.domain, 0U);
  EXPECT_EQ(sut.discovery, Discovery::kPeers);
  EXPECT_EQ(sut.hosts[0].prefix,
            std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path());
  ASSERT_EQ(sut.rigs.size(), 1U);
  EXPECT_EQ(sut.rigs[0].number, 1U);
}

TEST(InventoryTest, TwoRigsHaveEveryServiceTwiceAndAHostMayOnlyWatch) {
  const Inventory sut = sample_inventory(two_rigs());
  EXPECT_EQ(sut.host_of("rig", 1).name, "one");
  EXPECT_EQ(sut.host_of("rig", 7).name, "two");
  EXPECT_EQ(sut.rig(7).name, "right");
  EXPECT_THAT(sut.find_host("watcher")->services, IsEmpty());
}

TEST(InventoryTest, AFolderOfKeysIsSoughtBesideTheFile) {
  const SampleFolder folder;
  std::filesystem::create_directory(folder.path() / "keys");
  const Inventory sut =
      read_inventory(folder.file("lab: a\nsecurity: keys\nhosts: [{name: pc, address: 10.0.0.1, "
                                 "services: [" +
                                 kAllServices + "]}]"));
  EXPECT_EQ(sut.security, folder.path() / "keys");
}

/// A line of the file is `broken` instead of what it was; the refusal names the file, the line, the
/// column and what would be right.
struct Refusal {
  std::string name;
  std::string line, broken;  ///< a piece of the text, and what stands there instead
  std::string place;         ///< ":line:column: path"
  std::string got, want;
};

class InventoryRefusalTest : public testing::TestWithParam<Refusal> {};

// Lines are counted from 1: lab is line 1.
const std::string kGood = std::string(R"(lab: hall-3
domain: 12
hosts:
  - name: rig-pc
    address: 192.168.7.1
    start: [ssh, rig-pc]
    services: [rig, sensing, motion, cancellation]
  - name: desk
    address: 192.168.7.3
    prefix: /usr
    services: [)") + all_but({"rig", "sensing", "motion", "cancellation"}) +
                          R"(]
security: none
)";

TEST_P(InventoryRefusalTest, SaysWhereAndWhatWouldBeRight) {
  const Refusal& each = GetParam();
  std::string text = kGood;
  const auto at = text.find(each.line);
  ASSERT_NE(at, std::string::npos);
  ASSERT_EQ(text.find(each.line, at + 1), std::string::npos) << "not one piece of the text";
  ASSERT_NO_THROW(sample_inventory(text));
  text.replace(at, each.line.size(), each.broken);
  const SampleFolder folder;
  const std::filesystem::path file = folder.file(text);
  EXPECT_THAT(support::refusal([&] { read_inventory(file); }),
              AllOf(StartsWith(file.string() + each.place + ": got "), HasSubstr(each.got),
                    HasSubstr(", want "), HasSubstr(each.want)));
}

INSTANTIATE_TEST_SUITE_P(
    Inventory, InventoryRefusalTest,
    testing::Values(
        Refusal{"NoLab", "lab: hall-3\n", "", ":1:1: inventory", "no \"lab\"", "lab: a name"},
        Refusal{"LabWithSlash", "hall-3", "a/b", ":1:6: inventory.lab", "a/b", "letters, digits"},
        Refusal{"LabOfAList", "hall-3", "[a]", ":1:6: inventory.lab", "a list", "letters, digits"},
        Refusal{"DomainTooLarge", "12", "233", ":2:9: inventory.domain", "233", "from 0 to 232"},
        Refusal{"DomainOfWords", "12", "twelve", ":2:9: inventory.domain", "twelve", "0 to 232"},
        Refusal{"UnknownKey", "domain", "domian", ":2:1: inventory.domian", "unknown key",
                "\"domain\" perhaps"},
        Refusal{"UnknownKeyOfAHost", "prefix", "prefx", ":10:5: hosts[1].prefx", "unknown key",
                "\"prefix\" perhaps"},
        Refusal{"MisspeltKeyThatIsWanted", "hosts:", "host:", ":3:1: inventory.host", "unknown key",
                "\"hosts\" perhaps"},
        Refusal{"UnknownDiscovery", "domain: 12", "discovery: broadcast",
                ":2:12: inventory.discovery", "broadcast", "peers, server or multicast"},
        Refusal{"SeveralMachinesAndNoWordOnKeys", "security: none\n", "", ":4:3: inventory",
                "several machines and no \"security\"", "or security: none"},
        Refusal{"SecurityThatIsNotThere", "security: none", "security: keys",
                ":12:11: inventory.security", "no folder", "a folder with the lab's keys"},
        Refusal{"SecurityThroughAServer", "security: none", "security: .\ndiscovery: server",
                ":12:11: inventory.security", "strangers", "discovery: peers"},
        Refusal{"SecurityByMulticast", "security: none", "security: .\ndiscovery: multicast",
                ":12:11: inventory.security", "never authenticate", "discovery: peers"},
        Refusal{"HostsOfAWord", "  - name: rig-pc\n", "  rig-pc\n  - name: rig-pc\n", ":5:9",
                "illegal map value", "well-formed YAML"},
        Refusal{"HostWithoutName", "name: desk\n    address", "address", ":8:5: hosts[1]",
                "no \"name\"", "name: the machine"},
        Refusal{"HostWithoutAddress", "    address: 192.168.7.3\n", "", ":8:5: hosts[1]",
                "no \"address\"", "IPv4"},
        Refusal{"TwoHostsOfOneName", "name: desk", "name: rig-pc", ":8:11: hosts[1].name",
                "rig-pc a second time", "inventory.yaml:4:11"},
        Refusal{"TwoHostsAtOneAddress", "192.168.7.3", "192.168.7.1", ":9:14: hosts[1].address",
                "192.168.7.1 a second time", "inventory.yaml:5:14"},
        Refusal{"NameForAnAddress", "192.168.7.3", "desk.local", ":9:14: hosts[1].address",
                "desk.local", "IPv4"},
        Refusal{"AddressOutOfRange", "192.168.7.3", "192.168.7.333", ":9:14: hosts[1].address",
                "192.168.7.333", "IPv4"},
        Refusal{"MulticastAddress", "192.168.7.3", "239.255.0.1", ":9:14: hosts[1].address",
                "239.255.0.1", "of one interface"},
        Refusal{"AnyAddress", "192.168.7.3", "0.0.0.0", ":9:14: hosts[1].address", "0.0.0.0",
                "of one interface"},
        Refusal{"LoopbackBesideOthers", "192.168.7.1", "127.0.0.1", ":5:14: hosts[0].address",
                "127.0.0.1", "the others reach"},
        Refusal{"StartOfOneWord", "[ssh, rig-pc]", "ssh rig-pc", ":6:12: hosts[0].start",
                "ssh rig-pc", "[ssh, rig-pc]"},
        Refusal{"StartOfNoWords", "[ssh, rig-pc]", "[]", ":6:12: hosts[0].start", "a list",
                "[ssh, rig-pc]"},
        Refusal{"TwoHostsHere", "    start: [ssh, rig-pc]\n", "", ":7:5: hosts[1]", "no \"start\"",
                "but this machine"},
        Refusal{"RelativePrefix", "/usr", "usr", ":10:13: hosts[1].prefix", "usr", "absolute"},
        Refusal{"PrefixWithABlank", "/usr", "/opt/still hand", ":10:13: hosts[1].prefix",
                "/opt/still hand", "letters, digits"},
        Refusal{"UnknownService", "sensing", "sensnig", ":7:21: hosts[0].services[1]", "sensnig",
                "\"sensing\" perhaps"},
        Refusal{"AServiceTwice", "display", "motion", ":11:16: hosts[1].services[0]",
                "a second motion", "inventory.yaml:7:30"},
        Refusal{"AServiceTwiceOnAHost", "display", "display, display",
                ":11:25: hosts[1].services[1]", "a second display", "inventory.yaml:11:16"},
        Refusal{"AServiceNowhere", ", recorder", "", ":4:3: inventory.hosts",
                "no host that runs recorder", "exactly one host"},
        Refusal{"ServicesOfOneWord", "[rig, sensing, motion, cancellation]", "rig",
                ":7:15: hosts[0].services", "rig", "a list of services"},
        Refusal{"TwoRigsOfOneName", "domain: 12",
                "rigs: [{name: left, number: 1}, {name: left, number: 2}]", ":2:40: rigs[1].name",
                "left a second time", "inventory.yaml:2:15"},
        Refusal{"TwoRigsOfOneNumber", "domain: 12",
                "rigs: [{name: left, number: 1}, {name: right, number: 1}]",
                ":2:55: rigs[1].number", "1 a second time", "inventory.yaml:2:29"},
        Refusal{"RigOfNumberZero", "domain: 12", "rigs: [{name: left, number: 0}]",
                ":2:29: rigs[0].number", "0", "from 1"},
        Refusal{"RigsOfNothing", "domain: 12", "rigs: []", ":2:7: inventory.rigs", "a list",
                "{name: left, number: 1}"},
        Refusal{"WhoseServiceIsIt", "domain: 12",
                "rigs: [{name: left, number: 1}, {name: right, number: 2}]",
                ":7:16: hosts[0].services[0]", "rig", "{service: rig, rig: left}"},
        Refusal{"UnknownRig", "[rig,", "[{service: rig, rig: lefd},",
                ":7:36: hosts[0].services[0].rig", "lefd", "a rig: one of 1"}),
    [](const auto& each) { return each.param.name; });

TEST(InventoryTest, AServiceThatOneOfTwoRigsLacksIsNamedWithTheRig) {
  std::string text = two_rigs();
  const std::string last = ", {service: experiment, rig: right}";
  text.erase(text.find(last), last.size());
  EXPECT_THAT(support::refusal([&] { sample_inventory(text); }),
              HasSubstr("no host that runs experiment for rig right"));
}

TEST(InventoryTest, MoreServicesThanADomainHasPortsForAreRefused) {
  std::string rigs, services;
  for (int rig = 1; rig <= 13; ++rig) {
    const std::string number = std::to_string(rig);
    rigs += (rig > 1 ? ", " : "") + ("{name: r" + number) + ", number: " + number + "}";
    for (const std::string_view service : topics::kServices) {
      services += (services.empty() ? "" : ", ") + ("{service: " + std::string(service)) +
                  ", rig: r" + number + "}";
    }
  }
  EXPECT_THAT(
      support::refusal([&] {
        sample_inventory("lab: many\ndomain: 3\nrigs: [" + rigs +
                         "]\nhosts:\n  - name: one\n    address: 192.168.7.10\n    services: [" +
                         services + "]\n");
      }),
      HasSubstr("hosts[0].services: got " + std::to_string(13 * topics::kServices.size()) +
                " services, want at most 113"));
}

TEST(InventoryTest, SeveralMachinesHaveKeysOrSayThatTheyHaveNone) {
  const Inventory none = sample_inventory(kGood);
  EXPECT_TRUE(none.security.empty());
  EXPECT_TRUE(none.open_to_all());
  const SampleFolder folder;
  std::filesystem::create_directory(folder.path() / "keys");
  std::string text = kGood;
  text.replace(text.find("none"), 4, "keys");
  EXPECT_FALSE(read_inventory(folder.file(text)).open_to_all());
  // One machine needs no word.
  EXPECT_FALSE(sample_inventory("lab: a\nhosts: [{name: pc, address: 127.0.0.1, services: [" +
                                kAllServices + "]}]\n")
                   .open_to_all());
}

TEST(InventoryTest, AFileThatIsNotThereIsNamed) {
  EXPECT_THAT(support::refusal([&] { read_inventory("nowhere/inventory.yaml"); }),
              StartsWith("nowhere/inventory.yaml: got no such file"));
}

}  // namespace
}  // namespace stillhand::deploy::inventory_test
