// SPDX-License-Identifier: Apache-2.0
// What the generated profiles say, read as XML; that Fast DDS takes them: interface.lab_profiles.
#include "apps/deploy/profiles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <algorithm>
#include <string>
#include <vector>

#include "apps/deploy/ports.hpp"
#include "places.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/folder.hpp"
#include "tests/unit/deploy/sample_inventory.hpp"

namespace stillhand::deploy::profiles_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tinyxml2::XMLElement;

constexpr const char* kBase = STILLHAND_SOURCE "/qos/profiles.xml";

/// A generated file with the questions that the tests ask of it.
class Read {
 public:
  explicit Read(const std::string& xml) {
    EXPECT_EQ(document_.Parse(xml.c_str(), xml.size()), tinyxml2::XML_SUCCESS);
  }

  /// Text of every element at the end of a path below dds/profiles.
  [[nodiscard]] std::vector<std::string> texts(std::vector<std::string> path) const {
    std::vector<std::string> found;
    path.insert(path.begin(), {"dds", "profiles"});
    collect(document_.FirstChildElement("dds"), path, 0, found);
    return found;
  }

  /// "data_writer event" and so on: every pattern.
  [[nodiscard]] std::vector<std::string> patterns() const {
    std::vector<std::string> found;
    const XMLElement* profiles = document_.RootElement()->FirstChildElement("profiles");
    for (const XMLElement* each = profiles->FirstChildElement(); each != nullptr;
         each = each->NextSiblingElement()) {
      if (const char* name = each->Attribute("profile_name")) {
        tinyxml2::XMLPrinter printer(nullptr, true);
        if (std::string(each->Name()) != "participant") each->Accept(&printer);
        found.push_back(std::string(each->Name()) + " " + name + printer.CStr());
      }
    }
    return found;
  }

 private:
  static void collect(const XMLElement* at, const std::vector<std::string>& path, std::size_t depth,
                      std::vector<std::string>& found) {
    for (; at != nullptr; at = at->NextSiblingElement()) {
      if (path[depth] != at->Name()) continue;
      if (depth + 1 == path.size()) {
        found.emplace_back(at->GetText() == nullptr ? "" : at->GetText());
      } else {
        collect(at->FirstChildElement(), path, depth + 1, found);
      }
    }
  }

  tinyxml2::XMLDocument document_;
};

const std::vector<std::string> kWhiteList{"transport_descriptors", "transport_descriptor",
                                          "interfaceWhiteList", "address"};
const std::vector<std::string> kBuiltin{"participant", "rtps", "builtin"};

std::vector<std::string> below(std::vector<std::string> path,
                               const std::vector<std::string>& rest) {
  path.insert(path.end(), rest.begin(), rest.end());
  return path;
}

Inventory three_hosts(const std::string& discovery) {
  Inventory inventory = read_inventory(STILLHAND_SOURCE "/deploy/inventory.example.yaml");
  if (discovery == "server") inventory.discovery = Discovery::kServer;
  if (discovery == "multicast") inventory.discovery = Discovery::kMulticast;
  return inventory;
}

std::string any_host(const std::string& discovery) {
  const Inventory inventory = three_hosts(discovery);
  return LabProfiles(kBase).of(inventory, inventory.hosts[1]);
}

// A second address is a second socket that sends and a second thread that receives (README).
TEST(LabProfilesTest, AHostListensAtItsOwnAddressAlone) {
  for (const std::string discovery : {"peers", "server", "multicast"}) {
    const Read sut(any_host(discovery));
    EXPECT_THAT(sut.texts(kWhiteList), ElementsAre("192.168.7.2")) << discovery;
    EXPECT_EQ(sut.texts({"transport_descriptors", "transport_descriptor", "transport_id"}),
              sut.texts({"participant", "rtps", "userTransports", "transport_id"}));
  }
}

TEST(LabProfilesTest, PeersAreEveryHostAndNothingIsSentByMulticast) {
  const Read sut(any_host("peers"));
  EXPECT_THAT(sut.texts(below(kBuiltin, {"initialPeersList", "locator", "udpv4", "address"})),
              ElementsAre("192.168.7.1", "192.168.7.2", "192.168.7.3"));
  EXPECT_EQ(sut.texts(below(kBuiltin, {"metatrafficUnicastLocatorList", "locator"})).size(), 1U);
  EXPECT_THAT(sut.texts(below(kBuiltin, {"metatrafficMulticastLocatorList"})), IsEmpty());
  EXPECT_THAT(sut.texts({"transport_descriptors", "transport_descriptor", "maxInitialPeersRange"}),
              ElementsAre("16"));
}

TEST(LabProfilesTest, AHostWithManyProcessesIsSoughtAtAsManyPorts) {
  Inventory inventory = sample_inventory(two_rigs());
  for (std::uint32_t rig = 8; rig < 12; ++rig) {
    for (const auto service : topics::kServices) {
      inventory.hosts[0].services.push_back({std::string(service), rig});
    }
  }
  EXPECT_EQ(participants_sought(inventory), 5 * topics::kServices.size() + 7U);
}

TEST(LabProfilesTest, ClientsKnowTheServerOfTheFirstHost) {
  const Inventory inventory = three_hosts("server");
  const Read client(any_host("server"));
  const Read server(LabProfiles(kBase).of_server(inventory));
  const std::vector<std::string> config = below(kBuiltin, {"discovery_config"});
  const std::vector<std::string> at =
      below(config, {"discoveryServersList", "RemoteServer", "metatrafficUnicastLocatorList",
                     "locator", "udpv4"});
  EXPECT_THAT(client.texts(below(config, {"discoveryProtocol"})), ElementsAre("SUPER_CLIENT"));
  EXPECT_THAT(client.texts(below(at, {"address"})), ElementsAre("192.168.7.1"));
  EXPECT_THAT(client.texts(below(at, {"port"})), ElementsAre("10402"));  // 7400 + 250 12 + 2
  EXPECT_THAT(server.texts(below(config, {"discoveryProtocol"})), ElementsAre("SERVER"));
  EXPECT_THAT(
      server.texts(below(kBuiltin, {"metatrafficUnicastLocatorList", "locator", "udpv4", "port"})),
      ElementsAre("10402"));
  EXPECT_THAT(server.texts(kWhiteList), ElementsAre("192.168.7.1"));
}

TEST(LabProfilesTest, MulticastIsLeftToFastDds) {
  const Read sut(any_host("multicast"));
  EXPECT_THAT(sut.texts(below(kBuiltin, {"initialPeersList"})), IsEmpty());
  EXPECT_THAT(sut.texts(below(kBuiltin, {"metatrafficUnicastLocatorList"})), IsEmpty());
}

TEST(LabProfilesTest, PatternsAndLeasesAreThoseOfOneMachine) {
  const Read base(support::text_of(kBase));
  ASSERT_GT(base.patterns().size(), 10U);
  for (const std::string discovery : {"peers", "server", "multicast"}) {
    const Read sut(any_host(discovery));
    EXPECT_EQ(sut.patterns(), base.patterns()) << discovery;
    const auto lease = below(kBuiltin, {"discovery_config", "leaseDuration", "sec"});
    EXPECT_EQ(sut.texts(lease), base.texts(lease));
  }
}

TEST(LabProfilesTest, TheFileSaysWhatItWasMadeFrom) {
  EXPECT_THAT(any_host("peers"), HasSubstr("Generated by `stillhand deploy generate` from "
                                           "inventory.example.yaml for host screen-pc of lab "
                                           "hall-3"));
}

TEST(LabProfilesTest, BuffersAreThoseThatTheProfileAsksFor) {
  const LabProfiles sut(kBase);
  EXPECT_EQ(sut.buffers().receive, 4194304U);
  EXPECT_EQ(sut.buffers().send, 1048576U);
}

TEST(LabProfilesTest, AnotherFileIsRefused) {
  const SampleFolder folder;
  for (const std::string text : {"<dds><profiles/></dds>", "<dds><profiles>", "no XML"}) {
    EXPECT_THROW(LabProfiles(folder.file(text)), ConfigError) << text;
  }
  EXPECT_THROW(LabProfiles(folder.path() / "nothing.xml"), ConfigError);
}

}  // namespace
}  // namespace stillhand::deploy::profiles_test
