// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/deploy/checks.hpp"

namespace stillhand::deploy {

/// IPv4 addresses of this machine's interfaces, in the system's order.
std::vector<std::string> own_addresses();

/// The keys of each service that runs on the host, and of the tools' (tap, dashboard) those that
/// are there; without any of both, the tools'.
Finding check_keys_of(const Inventory& inventory, const Host& host);

/// Every check, of this machine as that host.  Reads /proc, /sys and the folder of keys.
std::vector<Finding> check_machine(const Inventory& inventory, const Host& host,
                                   const Buffers& buffers);

}  // namespace stillhand::deploy
