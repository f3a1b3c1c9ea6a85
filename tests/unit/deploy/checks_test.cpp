// SPDX-License-Identifier: Apache-2.0
// Each check on machines that are good, wrong and silent.
#include "apps/deploy/checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/capability.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <fstream>
#include <optional>
#include <thread>

#include "apps/deploy/machine.hpp"
#include "apps/deploy/ports.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/unit/deploy/sample_inventory.hpp"

namespace stillhand::deploy::checks_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
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

// As Linux 6.1 prints /proc/net/udp6: [::]:10400, [::1]:10402, [::ffff:127.0.0.1]:10410.
TEST(CheckTest, SocketsOfIPv6ThatIPv4ReachesAreFound) {
  const std::string six =
      "  sl  local_address                         remote_address                        st "
      "tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode ref pointer drops\n"
      " 1: 00000000000000000000000000000000:28A0 00000000000000000000000000000000:0000 07 "
      "00000000:00000000 00:00000000 00000000     0        0 4721 2 0000000000000000 0\n"
      " 2: 00000000000000000000000001000000:28A2 00000000000000000000000000000000:0000 07 "
      "00000000:00000000 00:00000000 00000000     0        0 4722 2 0000000000000000 0\n"
      " 3: 0000000000000000FFFF00000100007F:28AA 00000000000000000000000000000000:0000 07 "
      "00000000:00000000 00:00000000 00000000     0        0 4723 2 0000000000000000 0\n";
  EXPECT_THAT(
      taken_ports(kProcNetUdp + six, 10400, 10441),
      testing::ElementsAre(Field(&TakenPort::inode, 4711U), Field(&TakenPort::inode, 4712U),
                           Field(&TakenPort::inode, 4721U), Field(&TakenPort::inode, 4723U)));
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

TEST(CheckTest, TheDrivesPortHasToBeThereAndOpen) {
  SerialPortState port{.path = "/dev/ttyACM0"};
  EXPECT_THAT(check_serial_port(port), wrong("/dev/ttyACM0 is not there", "/dev/serial/by-id"));
  port.exists = true;
  port.group = "dialout";
  EXPECT_THAT(check_serial_port(port).mend, HasSubstr("adduser $USER dialout"));
  port.open_to_us = true;
  EXPECT_THAT(check_serial_port(port), good());
}

TEST(CheckTest, ASerialChipHandsBytesOnAtOnce) {
  SerialPortState port{.path = "/dev/ttyUSB0", .exists = true};
  EXPECT_THAT(check_latency_timer(port), not_checked());
  port.latency_timer = "16\n";
  EXPECT_THAT(check_latency_timer(port), wrong("collects bytes for 16 ms", "devices.rules"));
  port.latency_timer = "1\n";
  EXPECT_THAT(check_latency_timer(port), good());
}

TEST(CheckTest, ACanInterfaceHasToBeUp) {
  EXPECT_THAT(check_can_interface("can0", ""), wrong("no CAN interface can0", "drive.port"));
  EXPECT_THAT(check_can_interface("can0", "0x40080\n"), wrong("can0 is down", "ip link set can0"));
  EXPECT_THAT(check_can_interface("can0", "0x400c1\n"), good());
  EXPECT_THAT(check_can_interface("can0", "up"), not_checked());
}

TEST(CheckTest, EachDeviceOfTheRigIsLookedAt) {
  const auto file = std::filesystem::path(testing::TempDir()) / "devices.yaml";
  std::ofstream(file) << "signals:\n  platform: plain_udp\n";
  EXPECT_THAT(check_devices(file), IsEmpty());
  std::ofstream(file) << "signals:\n  force: drive\ndrive:\n  port: /dev/null\n";
  EXPECT_THAT(check_devices(file), SizeIs(2));
  std::ofstream(file) << "signals:\n  force: drive\ndrive: {kind: moteus_can, port: none0}\n";
  EXPECT_THAT(check_devices(file), ElementsAre(wrong("no CAN interface none0", "drive.port")));
  std::ofstream(file) << "signals: {acceleration: iio, force: iio}\n"
                         "accelerometer: {uri: \"ip:10.0.0.7\"}\n";
  const std::vector<Finding> seen = check_devices(file);
  EXPECT_THAT(seen, ElementsAre(not_checked(), not_checked()));
  EXPECT_THAT(seen.at(0).what, HasSubstr("ip:10.0.0.7"));
}

TEST(CheckTest, EveryProcessorMustKeepItsSpeed) {
  EXPECT_THAT(check_governor({"performance\n", "performance\n"}), good());
  EXPECT_THAT(check_governor({"performance\n", "powersave\n"}),
              wrong("powersave on 1 of 2", "cpupower"));
  EXPECT_THAT(check_governor({"schedutil\n", "performance\n", "powersave\n", "powersave\n"}),
              wrong("powersave, schedutil on 3 of 4", "after each restart"));
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

// Of nobody: no key is kept of it.
constexpr const char* kAuthority =
    "-----BEGIN CERTIFICATE-----\n"
    "MIIBPjCB8aADAgECAhQ24n+/PVrSpHp4JAsvBnlP4Bt8iTAFBgMrZXAwFDESMBAG\n"
    "A1UEAwwJYXV0aG9yaXR5MCAXDTI2MTEyMjIxNDEyNFoYDzIxMjYxMDI5MjE0MTI0\n"
    "WjAUMRIwEAYDVQQDDAlhdXRob3JpdHkwKjAFBgMrZXADIQDadRPUWh+6hJ1BZAOV\n"
    "2K/MwsJ+kJx4bs5Szl0v6NrfmaNTMFEwHQYDVR0OBBYEFHsFp/CAUN2Ivbcooz3h\n"
    "FFQi+GRXMB8GA1UdIwQYMBaAFHsFp/CAUN2Ivbcooz3hFFQi+GRXMA8GA1UdEwEB\n"
    "/wQFMAMBAf8wBQYDK2VwA0EAiKFEPjf1R6IN3Eo8CtZWOiFUuKj174jgSGzwifHU\n"
    "bWYGSVu4cYRPWebJKW1ONpkLvSyesykWl8QJNlmt4IGzAw==\n"
    "-----END CERTIFICATE-----\n";

// A watching host serves the page or records, or both, and needs the keys of no more.
TEST(CheckTest, OfAToolsKeysThoseThatAreThereAreLookedAt) {
  const SampleFolder folder;
  Inventory inventory = sample_inventory(two_rigs());
  inventory.security = folder.path();
  std::ofstream(folder.path() / "authority.pem") << kAuthority;
  const Host& watcher = *inventory.find_host("watcher");
  const auto tap = HasSubstr("tap/certificate.pem");
  const auto dashboard = HasSubstr("dashboard/certificate.pem");
  EXPECT_THAT(check_keys_of(inventory, watcher).what, AllOf(tap, dashboard));
  std::filesystem::create_directory(folder.path() / "dashboard");
  EXPECT_THAT(check_keys_of(inventory, watcher).what, AllOf(testing::Not(tap), dashboard));
  EXPECT_THAT(check_keys_of(inventory, inventory.hosts[0]).what,
              AllOf(HasSubstr("rig/certificate.pem"), dashboard, testing::Not(tap)));
}

TEST(CheckTest, SeveralMachinesWithoutKeysAreWrong) {
  Inventory inventory = sample_inventory(two_rigs());
  EXPECT_THAT(check_security(inventory), wrong("every program on the network", "make.sh"));
  inventory.security = "keys";
  EXPECT_EQ(check_security(inventory).state, State::kGood);
  inventory.security = "";
  inventory.hosts.resize(1);
  EXPECT_EQ(check_security(inventory).state, State::kGood);
}

TEST(CheckTest, TheAuthoritysPrivateKeyAmongTheServicesKeysIsWrong) {
  const SampleFolder folder;
  Inventory inventory = sample_inventory(two_rigs());
  inventory.lab = "a-lab-that-no-machine-has";
  inventory.security = folder.path();
  EXPECT_EQ(check_authority(authority_keys_of(inventory)).state, State::kGood);
  const auto key = folder.path() / "authority_key.pem";
  std::ofstream(key) << "a key";
  EXPECT_THAT(check_authority(authority_keys_of(inventory)),
              wrong(key.string(), "away from the lab's machines"));
}

TEST(CheckTest, WhetherOtherHostsAnswerIsNotChecked) {
  const Inventory inventory = sample_inventory(two_rigs());
  const Finding sut = reachability_commands(inventory, inventory.hosts[0]);
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

Inventory this_machine() {
  return sample_inventory("lab: bench\ndomain: " + std::to_string(support::own_domain()) +
                          "\nhosts: [{name: pc, address: 127.0.0.1, services: [" + kAllServices +
                          "]}]");
}

// The real machine: this test holds a port of a domain that nobody else has.
TEST(CheckTest, ThisMachineIsRead) {
  const Inventory inventory = this_machine();
  const auto before = check_machine(inventory, inventory.hosts[0], {1, 1});
  EXPECT_THAT(found(before, "address"), good());
  EXPECT_THAT(found(before, "buffers"), good());
  EXPECT_THAT(found(before, "ports"), good());
  const auto port = htons(static_cast<std::uint16_t>(DomainPorts(inventory.domain).first));
  sockaddr_in four{};
  four.sin_family = AF_INET;
  four.sin_port = port;
  four.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  sockaddr_in6 six{};  // [::], which takes IPv4's too
  six.sin6_family = AF_INET6;
  six.sin6_port = port;
  const auto held = [&](int family, const void* address, socklen_t size) {
    const int holder = socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const bool holds = bind(holder, static_cast<const sockaddr*>(address), size) == 0;
    const Finding ports = found(check_machine(inventory, inventory.hosts[0], {1, 1}), "ports");
    close(holder);
    return holds ? std::optional(ports) : std::nullopt;
  };
  EXPECT_THAT(held(AF_INET, &four, sizeof(four)),
              testing::Optional(wrong("(unit_deploy)", "another domain")));
  if (const auto ports = held(AF_INET6, &six, sizeof(six))) {  // where the machine has IPv6
    EXPECT_THAT(*ports, wrong("(unit_deploy)", "another domain"));
  }
}

/// In a thread without root's rights: the limits count.
std::vector<Finding> checked_without_rights(const Inventory& inventory) {
  std::vector<Finding> findings;
  std::thread([&] {
    __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
    __user_cap_data_struct none[_LINUX_CAPABILITY_U32S_3]{};
    ASSERT_EQ(syscall(SYS_capset, &header, none), 0);
    findings = check_machine(inventory, inventory.hosts[0], {1, 1});
  }).join();
  return findings;
}

// The kernel grants by the soft limit, and the programs ask by it, however large the hard one is.
TEST(CheckTest, TheSoftLimitCounts) {
  rlimit memory{};
  ASSERT_EQ(getrlimit(RLIMIT_MEMLOCK, &memory), 0);
  const rlimit less{65536, memory.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_MEMLOCK, &less), 0);
  const auto findings = checked_without_rights(this_machine());
  setrlimit(RLIMIT_MEMLOCK, &memory);
  EXPECT_THAT(found(findings, "memory-lock"), wrong("64 kB may be locked", "memlock unlimited"));
}

}  // namespace
}  // namespace stillhand::deploy::checks_test
