// SPDX-License-Identifier: Apache-2.0
// systemd units.  Each life sign (services/bus/reporting), ten times a second, feeds the
// watchdog.  systemd restarts a process that hangs, long after the interlock has opened.
#include <fmt/format.h>

#include "apps/deploy/host_files.hpp"
#include "services/system/process/real_time.hpp"

namespace stillhand::deploy {
namespace {

// Fast DDS lists the interfaces by netlink.  A program in a home could not start if homes were
// hidden.
std::string hardening(const Host& host, bool shows_a_screen, bool has_devices = false) {
  const std::filesystem::path inside = host.prefix.relative_path();
  const std::string top = inside.empty() ? "" : inside.begin()->string();
  const bool at_home = top == "home" || top == "root";
  return fmt::format(R"(NoNewPrivileges=yes
CapabilityBoundingSet=
ProtectSystem=strict
ProtectHome={}
PrivateTmp={}
ProtectKernelTunables=yes
ProtectKernelModules=yes
ProtectKernelLogs=yes
ProtectControlGroups=yes
ProtectClock=yes
RestrictNamespaces=yes
RestrictSUIDSGID=yes
RestrictAddressFamilies=AF_INET AF_INET6 AF_NETLINK AF_UNIX{}
LockPersonality=yes
SystemCallArchitectures=native
)",
                     at_home || shows_a_screen ? "read-only" : "yes",
                     shows_a_screen ? "no" : "yes",  // the screen's socket is in /tmp
                     has_devices ? " AF_CAN" : "");
}

// The service is the rig, whichever process it is.
bool is_of_devices(const Inventory& inventory, const Placement& placement) {
  return placement.service == "rig" && inventory.rig(placement.rig).devices;
}

std::string process_of(const Inventory& inventory, const Placement& placement) {
  return is_of_devices(inventory, placement) ? "device_rig" : placement.service;
}

// ProtectKernelTunables makes /sys read-only, and libiio writes there to open a local device: iiod,
// which has that right, stands between.
constexpr const char* kDevices =
    R"(# Serial ports alone; IIO devices of this machine through iiod (accelerometer.uri: ip:127.0.0.1).
SupplementaryGroups=dialout
DevicePolicy=closed
DeviceAllow=char-ttyACM rw
DeviceAllow=char-ttyUSB rw
DeviceAllow=char-ttyS rw
DeviceAllow=char-ttyAMA rw
)";

// Restart=always: a service ends with each session and begins the next one without old state.
std::string head(const Inventory& inventory, const Host& host, const std::string& description,
                 const std::string& after = "") {
  return fmt::format(R"(# {}
[Unit]
Description={}, lab {}
Documentation=man:stillhand(1)
Wants=network-online.target
After=network-online.target time-sync.target{}
PartOf=stillhand.target
{}
[Service]
Type=exec
User=stillhand
Restart=always
RestartSec=1
)",
                     generated_note(inventory, host), description, inventory.lab, after,
                     "StartLimitIntervalSec=60\nStartLimitBurst=10\n");
}

std::string command_of(const Inventory& inventory, const Host& host, const Placement& placement) {
  const std::string folder = installed_folder(inventory);
  std::string command = fmt::format(
      "{0}/bin/stillhand-{1} --domain {2} --rig {3} --profiles {4}/profiles.xml "
      "--config ${{STILLHAND_CONFIG}} --real-time --one-session",
      host.prefix.string(), process_of(inventory, placement), inventory.domain, placement.rig,
      folder);
  if (!inventory.security.empty()) command += " --security " + folder + "/security";
  return command;
}

// A new file for each start, also after a step back of the clock: the recorder never overwrites
// one, and one that is refused stays down.  systemd numbers each start.
std::string recorder_command(const Inventory& inventory, const std::string& command) {
  return "/bin/sh -c 'exec " + command + " --out /var/lib/stillhand/" + inventory.lab +
         "/$$(date -u +%%Y%%m%%dT%%H%%M%%SZ)_$$INVOCATION_ID.mcap'";
}

GeneratedFile unit_of(const Inventory& inventory, const Host& host, const Placement& placement) {
  const std::string& rig = inventory.rig(placement.rig).name;
  const bool screen = placement.service == "display";
  const bool recorder = placement.service == "recorder";
  const bool devices = is_of_devices(inventory, placement);
  std::string text = head(inventory, host,
                          fmt::format("Stillhand {} of rig {}{}", placement.service, rig,
                                      devices ? ", made of devices" : ""),
                          devices ? " iiod.service" : "");
  // 2: a setting, file, certificate or device is refused; a restart would not help.
  text += "RestartPreventExitStatus=2\n";
  text += fmt::format("Environment=STILLHAND_CONFIG={}/share/stillhand/deploy/config\n",
                      host.prefix.string());
  if (screen) {
    text +=
        "# The graphical session that shows the screen: set User, DISPLAY and XAUTHORITY with "
        "`systemctl edit`.\nEnvironment=DISPLAY=:0\n";
  }
  if (recorder) text += "StateDirectory=stillhand/" + inventory.lab + "\n";
  const std::string command = command_of(inventory, host, placement);
  text += "ExecStart=" + (recorder ? recorder_command(inventory, command) : command) + "\n";
  text += "NotifyAccess=main\nWatchdogSec=2\n";
  text += fmt::format(
      "CPUSchedulingPolicy=fifo\nCPUSchedulingPriority={0}\nLimitRTPRIO={0}\n"
      "LimitMEMLOCK=infinity\n",
      runtime::kControlPriority);
  if (devices) text += kDevices;
  text += hardening(host, screen, devices) + "\n[Install]\nWantedBy=stillhand.target\n";
  return {fmt::format("stillhand-{}@{}.service", process_of(inventory, placement), rig),
          std::move(text)};
}

GeneratedFile server_unit(const Inventory& inventory, const Host& host) {
  return {"stillhand-discovery.service",
          head(inventory, host, "Stillhand discovery server") +
              fmt::format("# From the Debian package fastdds-tools.\n"
                          "ExecStart=/usr/bin/fast-discovery-server -i 0 -x "
                          "{}/discovery_server.xml\n",
                          installed_folder(inventory)) +
              hardening(host, false) + "\n[Install]\nWantedBy=stillhand.target\n"};
}

}  // namespace

std::vector<GeneratedFile> units_of(const Inventory& inventory, const Host& host) {
  std::vector<GeneratedFile> units;
  if (inventory.discovery == Discovery::kServer && &host == &inventory.hosts.front()) {
    units.push_back(server_unit(inventory, host));
  }
  for (const Placement& placement : host.services) {
    if (placement.service != "experiment") units.push_back(unit_of(inventory, host, placement));
  }
  std::string wants;
  for (const GeneratedFile& unit : units) wants += "Wants=" + unit.name + "\n";
  units.push_back({"stillhand.target",
                   fmt::format("# {}\n[Unit]\nDescription=Stillhand on {}, lab {}\n{}\n[Install]\n"
                               "WantedBy=multi-user.target\n",
                               generated_note(inventory, host), host.name, inventory.lab, wants)});
  return units;
}

}  // namespace stillhand::deploy
