// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <filesystem>
#include <string>

#include "fast_dds/names.hpp"
#include "services/bus/identity.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime {

/// Reads the profile file into the factory, once a process.  @throws ConfigError
void load_profiles(const std::filesystem::path& file);

class DiscoveryListener;

/// A participant of the profile "stillhand_participant".
/// @param marked  it carries the replay's mark
/// @throws ConfigError for a bad domain, missing profile or a fault of the identity, BusError when
/// DDS refuses or runs without the requested security.
edds::DomainParticipant* create_participant(const std::filesystem::path& profiles,
                                            std::uint32_t domain, const std::string& name,
                                            bool marked, const Identity& identity,
                                            DiscoveryListener* listener);

/// A participant of this QoS that sends to no multicast group but for discovery.
/// @param listener  optional  @throws BusError when DDS refuses
edds::DomainParticipant* create_participant(std::uint32_t domain, edds::DomainParticipantQos qos,
                                            DiscoveryListener* listener);

/// The error of a profile file that lacks one.
ConfigError missing_profile(const std::filesystem::path& profiles, const char* kind,
                            std::string_view name);

}  // namespace stillhand::runtime
