// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/host_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/deploy/ports.hpp"
#include "services/system/process/real_time.hpp"

namespace stillhand::deploy {

GeneratedFile firewall_of(const Inventory& inventory, const Host& host) {
  std::string addresses = "127.0.0.0/8";
  for (const Host& each : inventory.hosts) {
    if (!each.address.starts_with("127.")) addresses += ", " + each.address;
  }
  std::string table = "stillhand_" + inventory.lab;
  std::ranges::replace(table, '-', '_');  // nft reads '-' as a minus
  const DomainPorts ports(inventory.domain);
  const std::string range =
      fmt::format("{}-{}", ports.first, ports.last(participants_sought(inventory)));
  return {"firewall.nft",
          fmt::format(R"(#!/usr/sbin/nft -f
# {0}
# The ports of DDS domain {1} are for the lab's hosts: packets from other hosts are dropped. If other rules drop by
# default, they also need:
#   udp dport {2} ip saddr {{ {3} }} accept
table inet {4}
delete table inet {4}
table inet {4} {{
  chain input {{
    type filter hook input priority filter; policy accept;
    udp dport {2} ip saddr != {{ {3} }} drop
    udp dport {2} meta nfproto ipv6 drop
  }}
}}
)",
                      generated_note(inventory, host), inventory.domain, range, addresses, table)};
}

GeneratedFile sysctl_of(const Inventory& inventory, const Host& host, const Buffers& buffers) {
  const DomainPorts ports(inventory.domain);
  return {"sysctl.conf", fmt::format(R"(# {}
# Without these limits the kernel cuts the buffers that profiles.xml asks for, and bursts are lost.
net.core.rmem_max = {}
net.core.wmem_max = {}
# Programs that ask for any port get no port of the domain.
net.ipv4.ip_local_reserved_ports = {}-{}
)",
                                     generated_note(inventory, host), buffers.receive, buffers.send,
                                     ports.first, ports.last(participants_sought(inventory)))};
}

namespace {

bool runs_a_rig_of_devices(const Inventory& inventory, const Host& host) {
  return std::ranges::any_of(host.services, [&](const Placement& placement) {
    return placement.service == "rig" && inventory.rig(placement.rig).devices;
  });
}

}  // namespace

// Which devices the rig has is said by devices.yaml, which is not the inventory's: without iiod the
// file does nothing.
std::optional<GeneratedFile> iiod_priority_of(const Inventory& inventory, const Host& host) {
  if (!runs_a_rig_of_devices(inventory, host)) return std::nullopt;
  return GeneratedFile{"iiod.conf",
                       fmt::format(R"(# {}
# Each block of samples is a round trip through two threads of iiod. With ordinary priority on a busy machine they come
# too late for the rig.
[Service]
CPUSchedulingPolicy=fifo
CPUSchedulingPriority={}
)",
                                   generated_note(inventory, host), runtime::kControlPriority)};
}

std::optional<GeneratedFile> device_rules_of(const Inventory& inventory, const Host& host) {
  if (!runs_a_rig_of_devices(inventory, host)) return std::nullopt;
  // Source: mjbots/moteus, docs/platforms (the adapter's rule).
  return GeneratedFile{"devices.rules", "# " + generated_note(inventory, host) +
                                            R"(
# An fdcanusb or mjcanfd-usb-1x: drive.port /dev/fdcanusb.
SUBSYSTEM=="tty", ATTRS{manufacturer}=="mjbots", ATTRS{product}=="fdcanusb", GROUP="dialout", MODE="0660", SYMLINK+="fdcanusb", ENV{ID_MM_PORT_IGNORE}="1"
# A USB serial chip hands its bytes on after 1 ms; as shipped, after 16.
ACTION=="add|change", SUBSYSTEM=="usb-serial", DRIVER=="ftdi_sio", ATTR{latency_timer}="1"
)"};
}

}  // namespace stillhand::deploy
