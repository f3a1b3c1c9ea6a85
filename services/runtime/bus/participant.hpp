// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <filesystem>
#include <string>

#include "services/contract/config_error.hpp"
#include "services/runtime/bus/batched_udp.hpp"
#include "services/runtime/bus/security.hpp"

namespace stillhand::runtime {

/// Reads the profile file into the factory, once a process.  @throws ConfigError
void load_profiles(const std::filesystem::path& file);

/// A participant of the profile "stillhand_participant".  @param marked  it carries the replay's
/// mark  @throws ConfigError for a bad domain, missing profile or a fault of the identity, BusError
/// when DDS refuses or runs without the security asked for.
/// @param take  where given and without an identity: the profile's UDPv4 is read in batches, and
/// this sees each datagram first
eprosima::fastdds::dds::DomainParticipant* create_participant(
    const std::filesystem::path& profiles, std::uint32_t domain, const std::string& name,
    bool marked, const Identity& identity,
    eprosima::fastdds::dds::DomainParticipantListener* listener, const TakeDatagram& take = {});

/// The error of a profile file that lacks one.
ConfigError missing_profile(const std::filesystem::path& profiles, const char* kind,
                            std::string_view name);

}  // namespace stillhand::runtime
