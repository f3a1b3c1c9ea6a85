// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/deploy/checks.hpp"

namespace stillhand::deploy {

/// IPv4 addresses of this machine's interfaces, in the system's order.
std::vector<std::string> own_addresses();

/// The keys of each service that runs on the host, and those of the tools (tap, dashboard) that are
/// present.  On a host with neither, the keys of both tools.
Finding check_keys_of(const Inventory& inventory, const Host& host);

/// Private keys of an authority in the folders from which a host's services read their keys.
std::vector<std::string> authority_keys_of(const Inventory& inventory);

/// The checks of a rig of devices on this machine.
/// @param devices  devices.yaml
/// @throws ConfigError for a file that is refused
std::vector<Finding> check_devices(const std::filesystem::path& devices);

/// Runs every check on this machine as that host.  Reads /proc, /sys and the folder of keys.
std::vector<Finding> check_machine(const Inventory& inventory, const Host& host,
                                   const Buffers& buffers);

}  // namespace stillhand::deploy
