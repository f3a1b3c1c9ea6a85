// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/machine.hpp"

#include <arpa/inet.h>
#include <grp.h>
#include <ifaddrs.h>
#include <linux/capability.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/timex.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <map>
#include <set>

#include "apps/deploy/generated_file.hpp"
#include "apps/deploy/ports.hpp"
#include "idl/topics.hpp"
#include "services/bus/identity.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/devices/device_rig/load_devices.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::deploy {
namespace {

namespace fs = std::filesystem;

std::optional<ClockState> clock_state() {
  timex state{};  // no modes: only reads
  if (adjtimex(&state) < 0) return std::nullopt;
  return ClockState{(state.status & STA_UNSYNC) != 0, static_cast<double>(state.maxerror) * 1e-6};
}

bool has_all_rights() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct data[_LINUX_CAPABILITY_U32S_3]{};
  if (syscall(SYS_capget, &header, data) != 0) return false;
  const auto has = [&](unsigned right) { return (data[0].effective & (1U << right)) != 0; };
  return has(CAP_SYS_NICE) && has(CAP_IPC_LOCK);
}

Rights rights() {
  rlimit priority{};
  rlimit memory{};
  getrlimit(RLIMIT_RTPRIO, &priority);
  getrlimit(RLIMIT_MEMLOCK, &memory);
  return {priority.rlim_cur, memory.rlim_cur, has_all_rights()};
}

// Programs by the inode of a socket that they hold.  Only root sees those of other users.
std::map<std::uint64_t, std::string> owners_of_sockets() {
  std::map<std::uint64_t, std::string> owners;
  std::error_code ignored;
  for (const auto& process : fs::directory_iterator("/proc", ignored)) {
    std::error_code error;
    for (const auto& file : fs::directory_iterator(process.path() / "fd", error)) {
      const std::string target = fs::read_symlink(file.path(), error).string();
      constexpr std::string_view kSocket = "socket:[";
      if (error || !target.starts_with(kSocket)) continue;
      std::string name = recording::text_of(process.path() / "comm");
      owners[std::stoull(target.substr(kSocket.size()))] = name.substr(0, name.find('\n'));
    }
  }
  return owners;
}

std::vector<TakenPort> taken_ports_with_owners(std::uint32_t first, std::uint32_t last) {
  std::vector<TakenPort> taken = taken_ports(
      recording::text_of("/proc/net/udp") + recording::text_of("/proc/net/udp6"), first, last);
  if (taken.empty()) return taken;
  const auto owners = owners_of_sockets();
  for (TakenPort& each : taken) {
    if (const auto owner = owners.find(each.inode); owner != owners.end()) {
      each.program = owner->second;
    }
  }
  return taken;
}

std::vector<std::string> governors() {
  std::vector<std::string> texts;
  std::error_code ignored;
  for (const auto& cpu : fs::directory_iterator("/sys/devices/system/cpu", ignored)) {
    std::string text = recording::text_of(cpu.path() / "cpufreq" / "scaling_governor");
    if (!text.empty()) texts.push_back(std::move(text));
  }
  return texts;
}

SerialPortState serial_port_state(const std::string& path, const std::string& key) {
  SerialPortState port{.path = path, .key = key};
  struct stat state = {};
  port.exists = stat(path.c_str(), &state) == 0;
  port.open_to_us = access(path.c_str(), R_OK | W_OK) == 0;
  if (!port.exists) return port;
  // NOLINTNEXTLINE(concurrency-mt-unsafe): one thread checks the machine
  const group* owner = getgrgid(state.st_gid);
  port.group = owner != nullptr ? owner->gr_name : std::to_string(state.st_gid);
  std::error_code error;
  const fs::path device = fs::canonical(path, error);
  port.latency_timer = recording::text_of(fs::path("/sys/bus/usb-serial/devices") /
                                          device.filename() / "latency_timer");
  return port;
}

}  // namespace

std::vector<std::string> own_addresses() {
  std::vector<std::string> addresses;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return addresses;
  for (const ifaddrs* each = list; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET) continue;
    char text[INET_ADDRSTRLEN]{};
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(each->ifa_addr)->sin_addr, text,
              sizeof(text));
    addresses.emplace_back(text);
  }
  freeifaddrs(list);
  return addresses;
}

Finding check_keys_of(const Inventory& inventory, const Host& host) {
  std::set<std::string> names;
  for (const Placement& placement : host.services) names.insert(placement.service);
  // A tool's keys are checked only if they are present: a host needs none of a tool that it does
  // not run.
  const std::array<std::string, 2> tools{std::string(topics::kTap),
                                         std::string(topics::kDashboard)};
  for (const std::string& tool : tools) {
    std::error_code unseen;
    if (fs::exists(inventory.security / tool, unseen)) names.insert(tool);
  }
  if (names.empty()) names.insert(tools.begin(), tools.end());
  std::set<std::string> refused;  // a set: for a wrong domain every key gives the same message
  std::vector<std::string> expiring;
  for (const std::string& name : names) {
    const auto identity = runtime::Identity::of(inventory.security, name);
    try {
      runtime::check_identity(identity, inventory.domain);
      const std::string warning = runtime::expiry_warning(identity);
      if (!warning.empty()) expiring.push_back(warning);
    } catch (const ConfigError& error) {
      refused.emplace(error.what());
    }
  }
  return check_keys({refused.begin(), refused.end()}, expiring);
}

std::vector<std::string> authority_keys_of(const Inventory& inventory) {
  std::vector<std::string> found;
  for (const fs::path& folder :
       {inventory.security, fs::path(installed_folder(inventory)) / "security"}) {
    std::error_code unseen;
    const fs::path key = folder / "authority_key.pem";
    if (fs::exists(key, unseen)) found.push_back(key.string());
  }
  return found;
}

std::vector<Finding> check_devices(const fs::path& devices) {
  const auto config = device_rig::load_devices(devices);
  const auto parts = device_rig::parts_of(config);
  std::vector<Finding> findings;
  const auto check = [&](const std::string& path, const std::string& key) {
    const SerialPortState port = serial_port_state(path, key);
    findings.push_back(check_serial_port(port));
    if (port.exists) findings.push_back(check_latency_timer(port));
  };
  if (parts.needs_drive() && parts.drive == device_rig::Parts::Drive::kMoteusCan) {
    findings.push_back(check_can_interface(
        config.drive.port,
        recording::text_of(fs::path("/sys/class/net") / config.drive.port / "flags")));
  } else if (parts.needs_drive()) {
    check(config.drive.port, "drive.port");
  }
  const auto check_context = [&](const device_rig::IioConfig& iio, const std::string& key) {
    findings.push_back(check_iio(iio.uri, iio.device, key + ".uri"));
  };
  if (parts.acceleration == device_rig::Parts::Source::kIio) {
    check_context(config.accelerometer, "accelerometer");
  }
  if (parts.force == device_rig::Parts::Source::kIio) check_context(config.load_cell, "load_cell");
  return findings;
}

std::vector<Finding> check_machine(const Inventory& inventory, const Host& host,
                                   const Buffers& buffers) {
  const DomainPorts ports(inventory.domain);
  const std::uint32_t last = ports.last(participants_sought(inventory));
  const Rights granted = rights();
  const fs::path net = "/proc/sys/net";
  std::vector<Finding> findings{
      check_address(host, own_addresses()),
      check_clock(clock_state()),
      check_real_time(granted),
      check_memory_lock(granted),
      check_buffers(recording::text_of(net / "core/rmem_max"),
                    recording::text_of(net / "core/wmem_max"), buffers),
      check_ports(taken_ports_with_owners(ports.first, last)),
      check_ephemeral_ports(recording::text_of(net / "ipv4/ip_local_port_range"),
                            recording::text_of(net / "ipv4/ip_local_reserved_ports"), ports.first,
                            last),
      check_governor(governors()),
      reachability_commands(inventory, host)};
  findings.push_back(check_security(inventory));
  if (!inventory.security.empty()) {
    findings.push_back(check_keys_of(inventory, host));
    findings.push_back(check_authority(authority_keys_of(inventory)));
  }
  return findings;
}

}  // namespace stillhand::deploy
