// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <string>

#include "fast_dds/names.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime {

/// What outside of the profiles would keep a participant from its peers without a word: a variable
/// of the environment that makes Fast DDS look for a discovery server, and an address of the
/// participant that no interface of this machine has, or one that is down.
/// @param where  the addresses were given
/// @throws ConfigError that names it
void check_surroundings(const edds::DomainParticipantQos& qos, const std::string& where);

}  // namespace stillhand::runtime
