// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/lab/hosts.hpp"
#include "apps/lab/lab_options.hpp"
#include "apps/lab/processes.hpp"

namespace stillhand::lab {

/// Every process of the session in the order of its start (idl/processes.hpp), with its arguments,
/// on its host.
/// @param experiment  participant of this verb, from which alone they accept a session's sources
/// @param sealed  what the rig reads of its undeclared effect; empty: it has none
std::vector<Launch> launches(const LabOptions& options, const Hosts& hosts,
                             const std::string& experiment, const std::string& sealed);

}  // namespace stillhand::lab
