// SPDX-License-Identifier: Apache-2.0
// Each check on machines that are good, wrong and silent.
#include "deploy/checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "deploy/machine.hpp"
#include "deploy/ports.hpp"
#include "support/own_domain.hpp"
#include "unit/deploy/sample_inventory.hpp"

namespace stillhand::deploy {
namespace {

using testing::AllOf;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

testing::Matcher<Finding> good() {
  return AllOf(Field("state", &Finding::state, State::kGood), Field(&Finding::mend, IsEmpty()));
}
testing::Matcher<Finding> wrong(const std::string& what, const std::string& mend) {
  return AllOf(Field("state", &Finding::state, State::kWrong),
               Field("what", &Finding::what, HasSubstr(what)),
               Field("mend", &Finding::mend, HasSubstr(mend)));
}
testing::Matcher<Finding> not_checked() {
  return Field("state", &Finding::state, State::kNotChecked);
}

TEST(CheckTest, TheAddressMustBeOnAnInterface) {
  const Host host{"rig-pc", "192.168.7.1", {}, "/usr", {}};
  EXPECT_THAT(check_address(host, {"127.0.0.1", "192.168.7.1"}), good());
  EXPECT_THAT(check_address(host, {"127.0.0.1", "192.168.7.11"}),
              wrong("192.168.7.1 is on no interface of this machine (it has 127.0.0.1, "
                    "192.168.7.11)",
                    "ip addr add 192.168.7.1"));
}

TEST(CheckTest, TheClockMustFollowAnother) {
  EXPECT_THAT(check_clock(ClockState{false, 0.0012}), good());
  EXPECT_THAT(check_clock(ClockState{false, 0.0012}).what, HasSubstr("1.2 ms"));
  EXPECT_THAT(check_clock(ClockState{true, 16.0}), wrong("not synchronised", "chrony"));
  EXPECT_THAT(check_clock(std::nullopt), not_checked());
}

TEST(CheckTest, TheRealTimePriorityAskedForMustBeGranted) {
  EXPECT_THAT(check_real_time({40, 0, false}), good());
  EXPECT_THAT(check_real_time({39, 0, false}), wrong("granted is 39, 40", "rtprio 40"));
  EXPECT_THAT(check_real_time({0, 0, true}), good());
}

TEST(CheckTest, MemoryMustBeLockable) {
  EXPECT_THAT(check_memory_lock({0, ~std::uint64_t{0}, false}), good());
  EXPECT_THAT(check_memory_lock({0, 8192 * 1024, false}), wrong("8192 kB", "memlock unlimited"));
  EXPECT_THAT(check_memory_lock({0, 0, true}), good());
}

TEST(CheckTest, TheKernelMustHaveRoomForTheProfilesBuffers) {
  const Buffers wanted{1000, 4000};
  EXPECT_THAT(check_buffers("4000\n", "1000\n", wanted), good());
  EXPECT_THAT(check_buffers("3999\n", "1000\n", wanted), wrong("rmem_max is 3999", "sysctl.conf"));
  EXPECT_THAT(check_buffers("4000\n", "999\n", wanted), wrong("wmem_max 999", "sysctl.conf"));
  EXPECT_THAT(check_buffers("", "", wanted), not_checked());
}

// As Linux 6.1 prints it: 10.0.0.1:10410, 127.0.0.1:10400, 0.0.0.0:10442.
const std::string kProcNetUdp =
    "   sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout "
    "inode ref pointer drops\n"
    "  100: 0100000A:28AA 00000000:0000 07 00000000:00000000 00:00000000 00000000  1000        0 "
    "4711 2 0000000000000000 0\n"
    "  101: 0100007F:28A0 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 "
    "4712 2 0000000000000000 0\n"
    "  102: 00000000:28CA 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 "
    "4713 2 0000000000000000 0\n";

TEST(CheckTest, SocketsOnTheDomainsPortsAreFound) {
  const auto sut = taken_ports(kProcNetUdp, 10400, 10441);
  ASSERT_THAT(sut, SizeIs(2));
  EXPECT_EQ(sut[0].port, 10410U);
  EXPECT_EQ(sut[0].inode, 4711U);
  EXPECT_EQ(sut[1].port, 10400U);
  EXPECT_THAT(taken_ports("", 10400, 10441), IsEmpty());
  EXPECT_THAT(taken_ports("rubbish\n1: 2 3 4 5 6 7 8 9 10 11\n", 0, 65535), IsEmpty());
}

TEST(CheckTest, AnotherProgramOnThePortsIsNamed) {
  EXPECT_THAT(check_ports({}), good());
  EXPECT_THAT(check_ports({{10410, 1, "stillhand-rig"}, {10402, 2, "fast-discovery-"}}), good());
  EXPECT_THAT(check_ports({{10410, 1, "stillhand"}, {10400, 2, "quake"}}),
              wrong("10400 (quake)", "another domain"));
  EXPECT_THAT(check_ports({{10400, 2, ""}}), not_checked());
}

TEST(CheckTest, ProgramsThatAskForAnyPortMustGetNoneOfTheDomains) {
  EXPECT_THAT(check_ephemeral_ports("32768\t60999\n", "\n", 10400, 10441), good());
  EXPECT_THAT(check_ephemeral_ports("32768\t60999\n", "\n", 32750, 32781),
              wrong("may get 32768", "ip_local_reserved_ports=32750-32781"));
  EXPECT_THAT(check_ephemeral_ports("32768\t60999\n", "\n", 60990, 61031),
              wrong("may get 60990", "domain below 100"));
  EXPECT_THAT(check_ephemeral_ports("32768\t60999\n", "8080,33000-33041\n", 33000, 33041), good());
  EXPECT_THAT(check_ephemeral_ports("32768\t60999\n", "33000-33040\n", 33000, 33041),
              wrong("may get 33041", ""));
  EXPECT_THAT(check_ephemeral_ports("", "", 10400, 10441), not_checked());
}

TEST(CheckTest, EveryProcessorMustKeepItsSpeed) {
  EXPECT_THAT(check_governor({"performance\n", "performance\n"}), good());
  EXPECT_THAT(check_governor({"performance\n", "powersave\n"}), wrong("powersave", "cpupower"));
  EXPECT_THAT(check_governor({}), not_checked());
}

TEST(CheckTest, KeysMustBeGoodAndStayGood) {
  EXPECT_THAT(check_keys({}, {}), good());
  EXPECT_THAT(check_keys({"rig/certificate.pem: got one that expired"}, {"sensing: soon"}),
              wrong("one that expired", "make.sh"));
  EXPECT_THAT(check_keys({}, {"rig/certificate.pem expires on"}), wrong("expires on", "make.sh"));
}

TEST(CheckTest, KeysThatAreNotThereAreNamedForEachServiceOfTheHost) {
  const SampleFolder folder;
  Inventory inventory = sample_inventory(two_rigs());
  inventory.security = folder.path();
  EXPECT_THAT(check_keys_of(inventory, inventory.hosts[0]),
              wrong(folder.path().string(), "make.sh"));
  EXPECT_THAT(check_keys_of(inventory, *inventory.find_host("watcher")),
              wrong(folder.path().string(), "make.sh"));
}

TEST(CheckTest, ThatTheOthersAnswerIsNotPretended) {
  const Inventory inventory = sample_inventory(two_rigs());
  const Finding sut = tell_reachability(inventory, inventory.hosts[0]);
  EXPECT_THAT(sut, not_checked());
  EXPECT_EQ(sut.mend, "ping -c 1 10.0.0.2; ping -c 1 10.0.0.3");
}

Finding found(const std::vector<Finding>& all, const std::string& check) {
  for (const Finding& each : all) {
    if (each.check == check) return each;
  }
  ADD_FAILURE() << "no check " << check;
  return {};
}

// The real machine: this test holds a port of a domain that nobody else has.
TEST(CheckTest, ThisMachineIsRead) {
  const Inventory inventory = sample_inventory(
      "lab: bench\ndomain: " + std::to_string(support::own_domain()) +
      "\nhosts: [{name: pc, address: 127.0.0.1, services: [" + kAllServices + "]}]");
  const auto before = check_machine(inventory, inventory.hosts[0], {1, 1});
  EXPECT_THAT(found(before, "address"), good());
  EXPECT_THAT(found(before, "buffers"), good());
  EXPECT_THAT(found(before, "ports"), good());
  const int holder = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(DomainPorts(inventory.domain).first));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(bind(holder, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  const auto after = check_machine(inventory, inventory.hosts[0], {1, 1});
  close(holder);
  EXPECT_THAT(found(after, "ports"), wrong("(unit_deploy_che", "another domain"));
}

}  // namespace
}  // namespace stillhand::deploy
