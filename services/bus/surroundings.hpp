// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <filesystem>

#include "fast_dds/names.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime {

/// What outside of the profiles would keep a participant from its peers without a word: a variable
/// of the environment that makes Fast DDS look for a discovery server, and an address of the
/// profiles that no interface of this machine has, or one that is down.
/// @throws ConfigError that names it
void check_surroundings(const edds::DomainParticipantQos& qos,
                        const std::filesystem::path& profiles);

}  // namespace stillhand::runtime
