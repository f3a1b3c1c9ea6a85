// SPDX-License-Identifier: Apache-2.0
// Fast DDS takes the profiles of a generated lab: two participants match and exchange a sample by
// each discovery, on loopback.  A process reads a profile of one name once: each case is a child.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>

#include "apps/deploy/checks.hpp"
#include "apps/deploy/generate.hpp"
#include "apps/deploy/ports.hpp"
#include "idl/session.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/participant.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/wait.hpp"
#include "tests/unit/deploy/sample_inventory.hpp"

namespace stillhand::deploy {
namespace {

using support::eventually;

/// A lab of this machine alone, generated.
struct OneHost {
  explicit OneHost(const std::string& discovery)
      : inventory(read_inventory(folder.file(
            "lab: bench\ndomain: " + std::to_string(support::own_domain()) +
            "\ndiscovery: " + discovery + "\nhosts: [{name: pc, address: 127.0.0.1, services: [" +
            kAllServices + "]}]"))) {
    generate(inventory, LabProfiles(STILLHAND_SOURCE "/qos/profiles.xml"), folder.path());
  }

  [[nodiscard]] runtime::Bus::Options options(const std::string& service) const {
    runtime::Bus::Options options;
    options.service = service;
    options.domain = inventory.domain;
    options.profiles = folder.path() / "pc" / "profiles.xml";
    return options;
  }

  SampleFolder folder;
  Inventory inventory;
};

/// @return what went wrong, or nullptr
const char* match_and_send(const OneHost& lab,
                           std::chrono::milliseconds limit = std::chrono::seconds(20)) {
  runtime::Bus writer(lab.options("experiment"));
  runtime::Bus reader(lab.options("rig"));
  std::atomic<int> trial{0};
  auto publisher = writer.publisher<stillhand_msgs::TrialControl>(topics::kTrialControl);
  reader.subscribe<stillhand_msgs::TrialControl>(
      topics::kTrialControl,
      [&](const stillhand_msgs::TrialControl& m, const runtime::Arrival&) { trial = m.trial(); });
  writer.start();
  reader.start();
  stillhand_msgs::TrialControl message;
  message.trial(7);
  publisher.write(message);
  if (!eventually([&] { return reader.report().front().matched == 1; }, limit)) return "no match";
  return eventually([&] { return trial.load() == 7; }) ? nullptr : "no sample";
}

// Nobody else is on the domain: a socket at its multicast port is this process's.
bool listens_to_multicast(const OneHost& lab) {
  const std::string text = support::text_of("/proc/net/udp");
  const DomainPorts ports(lab.inventory.domain);
  return !taken_ports(text, ports.multicast(), ports.multicast()).empty();
}

/// Ends the child.
[[noreturn]] void finish(const char* wrong) {
  if (wrong != nullptr) std::fprintf(stderr, "%s\n", wrong);
  std::_Exit(wrong == nullptr ? 0 : 1);
}

TEST(LabProfilesTest, ParticipantsFindEachOtherByTheInventoryWithoutMulticast) {
  const OneHost lab("peers");
  EXPECT_EXIT(
      {
        const runtime::Bus bus(lab.options("rig"));
        finish(listens_to_multicast(lab) ? "it listens to multicast" : match_and_send(lab));
      },
      testing::ExitedWithCode(0), "");
}

TEST(LabProfilesTest, ParticipantsFindEachOtherByMulticastWhereItIsChosen) {
  const OneHost lab("multicast");
  EXPECT_EXIT(
      {
        const runtime::Bus bus(lab.options("rig"));
        finish(listens_to_multicast(lab) ? match_and_send(lab) : "it does not listen to multicast");
      },
      testing::ExitedWithCode(0), "");
}

// The server is a process of its own, as on the first host: fast-discovery-server reads the same.
TEST(LabProfilesTest, ParticipantsFindEachOtherThroughTheServer) {
  const OneHost lab("server");
  const pid_t server = fork();
  if (server == 0) {
    using namespace eprosima::fastdds::dds;
    auto* factory = DomainParticipantFactory::get_instance();
    runtime::load_profiles(lab.folder.path() / "pc" / "discovery_server.xml");
    factory->create_participant_with_profile(lab.inventory.domain, "stillhand_participant");
    pause();
  }
  EXPECT_EXIT(finish(match_and_send(lab)), testing::ExitedWithCode(0), "");
  kill(server, SIGKILL);
  waitpid(server, nullptr, 0);
  EXPECT_EXIT(finish(match_and_send(lab, std::chrono::seconds(3))), testing::ExitedWithCode(1),
              "no match")
      << "found without the server";
}

}  // namespace
}  // namespace stillhand::deploy
