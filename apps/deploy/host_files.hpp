// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "apps/deploy/generated_file.hpp"
#include "apps/deploy/profiles.hpp"

namespace stillhand::deploy {

/// systemd units of a host: one for each service but the experiment, which a person starts; one for
/// the discovery server on its host; and stillhand.target, which wants them all.
std::vector<GeneratedFile> units_of(const Inventory& inventory, const Host& host);

/// nftables rules that reserve the domain's ports for the lab's hosts.
GeneratedFile firewall_of(const Inventory& inventory, const Host& host);

/// Kernel settings: limits for the buffers that the profiles ask for, and the domain's ports
/// reserved.
GeneratedFile sysctl_of(const Inventory& inventory, const Host& host, const Buffers& buffers);

/// udev rules for the devices of a rig: names, rights, and a serial chip that hands its bytes on at
/// once.  Nothing where the host runs no rig of devices.
std::optional<GeneratedFile> device_rules_of(const Inventory& inventory, const Host& host);

/// Priority of the control loop for iiod, which stands in its path
/// (services/devices/device_rig/DEVICES.md, "IIO devices").  Nothing where the host runs no rig of
/// devices.
std::optional<GeneratedFile> iiod_priority_of(const Inventory& inventory, const Host& host);

}  // namespace stillhand::deploy
