// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <set>
#include <sstream>

#include "services/system/process/real_time.hpp"

namespace stillhand::deploy {
namespace {

Finding good(std::string check, std::string what) {
  return {std::move(check), State::kGood, std::move(what), {}};
}
Finding wrong(std::string check, std::string what, std::string mend) {
  return {std::move(check), State::kWrong, std::move(what), std::move(mend)};
}
Finding not_checked(std::string check, std::string what, std::string mend = {}) {
  return {std::move(check), State::kNotChecked, std::move(what), std::move(mend)};
}

template <typename Number>
std::optional<Number> number_at(std::string_view text, int base = 10) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  Number value{};
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc{}) return std::nullopt;
  return value;
}

/// First and last port of one item of "8080,9148-9160".
using PortRange = std::pair<std::uint32_t, std::uint32_t>;

std::vector<PortRange> reserved_ranges(std::string_view text) {
  std::vector<PortRange> ranges;
  std::istringstream items{std::string(text)};
  for (std::string item; std::getline(items, item, ',');) {
    const auto from = number_at<std::uint32_t>(item);
    if (!from) continue;
    const auto dash = item.find('-');
    const auto to = dash == std::string::npos
                        ? from
                        : number_at<std::uint32_t>(std::string_view(item).substr(dash + 1));
    ranges.emplace_back(*from, to.value_or(*from));
  }
  return ranges;
}

bool covers(const std::vector<PortRange>& ranges, std::uint32_t port) {
  return std::ranges::any_of(
      ranges, [&](const PortRange& each) { return each.first <= port && port <= each.second; });
}

/// Whether a local address receives IPv4 datagrams.  Of the IPv6 addresses, [::] and ::ffff:0:0/96
/// do; they are written as four words in this machine's byte order.
bool hears_ipv4(std::string_view address) {
  constexpr std::size_t kIpv4Digits = 8;
  const bool mapped = std::endian::native == std::endian::little
                          ? address.starts_with("0000000000000000FFFF0000")
                          : address.starts_with("00000000000000000000FFFF");
  return address.size() == kIpv4Digits || mapped ||
         address.find_first_not_of('0') == std::string_view::npos;
}

}  // namespace

Finding check_address(const Host& host, const std::vector<std::string>& own) {
  if (std::ranges::find(own, host.address) != own.end()) {
    return good("address", host.address + " is on an interface");
  }
  return wrong("address",
               fmt::format("{} is on no interface of this machine (it has {})", host.address,
                           fmt::join(own, ", ")),
               fmt::format("give an interface that address (ip addr add {}/24 dev NAME), or write "
                           "one of this machine's addresses into the inventory",
                           host.address));
}

Finding check_clock(const std::optional<ClockState>& clock) {
  if (!clock) return not_checked("clock", "the kernel gives no state of its clock");
  if (!clock->unsynchronised) {
    return good("clock",
                fmt::format("synchronised, error at most {:.1f} ms", clock->worst_error_s * 1e3));
  }
  return wrong(
      "clock", "not synchronised with another clock",
      "sudo apt install chrony; if the lab has a server, write \"server ADDRESS iburst\" into "
      "/etc/chrony/conf.d/lab.conf; sudo systemctl restart chrony; chronyc tracking");
}

Finding check_real_time(const Rights& rights) {
  constexpr std::uint64_t kWanted = runtime::kControlPriority;
  if (rights.all || rights.real_time_priority >= kWanted) {
    return good("real-time", "SCHED_FIFO is granted");
  }
  return wrong("real-time",
               fmt::format("the largest real-time priority granted is {}, {} is needed",
                           rights.real_time_priority, kWanted),
               fmt::format("echo '@stillhand - rtprio {}' | sudo tee -a "
                           "/etc/security/limits.d/stillhand.conf; sudo groupadd -f stillhand; "
                           "sudo adduser $USER stillhand; log in again",
                           kWanted));
}

Finding check_memory_lock(const Rights& rights) {
  if (rights.all || rights.locked_memory >= runtime::kMemoryToLock) {
    return good("memory-lock", "large enough");
  }
  return wrong("memory-lock",
               fmt::format("{} kB may be locked, no limit is needed", rights.locked_memory / 1024),
               "echo '@stillhand - memlock unlimited' | sudo tee -a "
               "/etc/security/limits.d/stillhand.conf; log in again");
}

Finding check_buffers(std::string_view rmem_max, std::string_view wmem_max, const Buffers& wanted) {
  const auto receive = number_at<std::uint64_t>(rmem_max);
  const auto send = number_at<std::uint64_t>(wmem_max);
  if (!receive || !send) return not_checked("buffers", "the kernel gives no limits of them");
  if (*receive >= wanted.receive && *send >= wanted.send) {
    return good("buffers", fmt::format("{} bytes to receive, {} to send", *receive, *send));
  }
  return wrong(
      "buffers",
      fmt::format("net.core.rmem_max is {}, wmem_max {}; profiles.xml asks for {} and {}", *receive,
                  *send, wanted.receive, wanted.send),
      "sudo cp HOST/sysctl.conf /etc/sysctl.d/60-stillhand.conf (deploy generate writes it); sudo "
      "sysctl --system");
}

// "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout
// inode"
std::vector<TakenPort> taken_ports(std::string_view proc_net_udp, std::uint32_t first,
                                   std::uint32_t last) {
  constexpr std::size_t kLocal = 1;
  constexpr std::size_t kInode = 9;
  std::vector<TakenPort> taken;
  std::istringstream lines{std::string(proc_net_udp)};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream columns(line);
    std::vector<std::string> words;
    for (std::string word; columns >> word;) words.push_back(word);
    if (words.size() <= kInode) continue;
    const auto colon = words[kLocal].find(':');
    if (colon == std::string::npos || !hears_ipv4(words[kLocal].substr(0, colon))) continue;
    const auto port =
        number_at<std::uint32_t>(std::string_view(words[kLocal]).substr(colon + 1), 16);
    const auto inode = number_at<std::uint64_t>(words[kInode]);
    if (port && inode && *port >= first && *port <= last) taken.push_back({*port, *inode, {}});
  }
  return taken;
}

Finding check_ports(const std::vector<TakenPort>& taken) {
  std::set<std::string> others;
  bool unknown = false;
  for (const TakenPort& each : taken) {
    if (each.program.starts_with("stillhand") || each.program.starts_with("fast-discovery")) {
      continue;
    }
    if (each.program.empty()) unknown = true;
    others.insert(
        fmt::format("{} ({})", each.port, each.program.empty() ? "another user's" : each.program));
  }
  if (others.empty()) return good("ports", "no other program uses a port of the domain");
  const std::string list = fmt::format("taken: UDP {}", fmt::join(others, ", "));
  if (unknown) return not_checked("ports", list, "only root sees the program: sudo ss -ulnp");
  return wrong("ports", list, "stop that program, or give the lab another domain");
}

Finding check_ephemeral_ports(std::string_view range, std::string_view reserved,
                              std::uint32_t first, std::uint32_t last) {
  const auto from = number_at<std::uint32_t>(range);
  const auto gap = range.find_first_of(" \t");
  const auto to = gap == std::string_view::npos ? std::nullopt
                                                : number_at<std::uint32_t>(range.substr(gap + 1));
  if (!from || !to) return not_checked("any-port", "the kernel gives no range of such ports");
  const std::vector<PortRange> kept = reserved_ranges(reserved);
  for (std::uint32_t port = std::max(first, *from); port <= std::min(last, *to); ++port) {
    if (covers(kept, port)) continue;
    return wrong(
        "any-port",
        fmt::format("programs that ask for any port may get {}, which is one of the domain's ports "
                    "{} to {}",
                    port, first, last),
        fmt::format("sudo sysctl -w net.ipv4.ip_local_reserved_ports={}-{} (HOST/"
                    "sysctl.conf contains it), or use a domain below 100",
                    first, last));
  }
  return good("any-port", "no program can get one of the domain's ports by chance");
}

Finding check_governor(const std::vector<std::string>& governors) {
  if (governors.empty()) return not_checked("governor", "the processors have none");
  std::set<std::string> others;
  std::size_t count = 0;
  for (const std::string& each : governors) {
    const std::string name = each.substr(0, each.find('\n'));
    if (name == "performance") continue;
    others.insert(name);
    ++count;
  }
  if (others.empty()) return good("governor", "performance");
  return wrong("governor",
               fmt::format("{} on {} of {} processors, performance is needed: otherwise the clock "
                           "speed follows the load, or stays low",
                           fmt::join(others, ", "), count, governors.size()),
               "sudo apt install linux-cpupower; sudo cpupower frequency-set -g performance, "
               "again after each restart");
}

Finding check_serial_port(const SerialPortState& port) {
  if (!port.exists) {
    return wrong("serial-port", port.path + " is not there",
                 "connect the device, and name its port in devices.yaml (" + port.key +
                     "); /dev/serial/by-id has names that stay");
  }
  if (!port.open_to_us) {
    return wrong("serial-port", port.path + " may not be read and written",
                 fmt::format("sudo adduser $USER {}; log in again", port.group));
  }
  return good("serial-port", port.path + " may be read and written");
}

Finding check_can_interface(const std::string& name, std::string_view flags) {
  constexpr unsigned kUp = 1;  // IFF_UP of <linux/if.h>
  if (flags.empty()) {
    return wrong("can", "there is no CAN interface " + name,
                 "connect the adapter, and name its interface in devices.yaml (drive.port)");
  }
  if (flags.starts_with("0x")) flags.remove_prefix(2);
  const auto value = number_at<unsigned>(flags, 16);
  if (!value) return not_checked("can", "the kernel gives no state of " + name);
  if ((*value & kUp) != 0) return good("can", name + " is up");
  return wrong(
      "can", name + " is down",
      fmt::format("sudo ip link set {} up type can bitrate 1000000 dbitrate 5000000 sjw 10 "
                  "dsjw 5 sample-point 0.666 dsample-point 0.666 restart-ms 1000 fd on",
                  name));
}

Finding check_iio(const std::string& uri, const std::string& device, const std::string& key) {
  return not_checked("iio", fmt::format("{} at {} ({})", device, uri, key),
                     fmt::format("iio_info -u {} lists the devices that answer", uri));
}

Finding check_latency_timer(const SerialPortState& port) {
  const auto timer_ms = number_at<int>(port.latency_timer);
  if (!timer_ms) return not_checked("latency", port.path + " has no latency timer");
  if (*timer_ms <= 1) return good("latency", fmt::format("{} ms", *timer_ms));
  return wrong("latency",
               fmt::format("the serial chip of {} collects bytes for {} ms, 1 is needed", port.path,
                           *timer_ms),
               "`stillhand deploy generate` writes HOST/devices.rules: copy it to "
               "/etc/udev/rules.d/60-stillhand-devices.rules and connect the chip again");
}

Finding check_keys(const std::vector<std::string>& refused,
                   const std::vector<std::string>& expiring) {
  const std::string mend =
      "copy the new folder of deploy/security/make.sh to every host of the lab";
  if (!refused.empty()) return wrong("keys", fmt::format("{}", fmt::join(refused, "; ")), mend);
  if (!expiring.empty()) return wrong("keys", fmt::format("{}", fmt::join(expiring, "; ")), mend);
  return good("keys", "valid for every service of this host, for at least 30 days");
}

Finding check_security(const Inventory& inventory) {
  if (!inventory.open_to_all()) {
    return good("security", inventory.security.empty() ? "one machine needs no keys"
                                                       : "the bus takes only those with keys");
  }
  return wrong("security",
               "none: every program on the network of these machines can read, disturb or imitate "
               "a session",
               "deploy/security/make.sh FOLDER, and `security: FOLDER` in the inventory");
}

Finding check_authority(const std::vector<std::string>& authority_keys) {
  if (authority_keys.empty()) {
    return good("authority", "its private key is in no folder that services read");
  }
  return wrong(
      "authority",
      fmt::format("{}: who reads it can certify any program", fmt::join(authority_keys, ", ")),
      "move it to a place away from the lab's machines, or delete it");
}

Finding reachability_commands(const Inventory& inventory, const Host& host) {
  std::vector<std::string> others;
  for (const Host& each : inventory.hosts) {
    if (each.name != host.name) others.push_back("ping -c 1 " + each.address);
  }
  if (others.empty()) return good("others", "the inventory has no other host");
  return not_checked("others", "a ping needs rights; type the commands",
                     fmt::format("{}", fmt::join(others, "; ")));
}

}  // namespace stillhand::deploy
