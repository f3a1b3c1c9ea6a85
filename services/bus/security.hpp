// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/bus/identity.hpp"

namespace eprosima::fastdds::dds {
class DomainParticipant;
class DomainParticipantQos;
}  // namespace eprosima::fastdds::dds

namespace stillhand::runtime {

/// Sets the DDS Security properties, and discovery by initial peers on the loopback where the
/// profile has none.  @throws ConfigError for a discovery server, by profile or environment: it
/// hands secured samples to unsecured clients (Fast DDS 2.9.1); for multicast on another address
/// and for a profile with several receiving threads: some participants would not authenticate.
void secure(eprosima::fastdds::dds::DomainParticipantQos& qos, const Identity& identity);

/// The participant authenticates as `identity`.  Fast DDS ignores a misspelt property and runs
/// without security; but where its authentication runs, the GUID begins with guid_start().  Without
/// access control or cryptography no endpoint would match it, which every session reports.
bool is_secured(const eprosima::fastdds::dds::DomainParticipant& participant,
                const Identity& identity);

}  // namespace stillhand::runtime
