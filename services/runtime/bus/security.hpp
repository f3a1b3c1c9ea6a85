// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace eprosima::fastdds::dds {
class DomainParticipant;
class DomainParticipantQos;
}  // namespace eprosima::fastdds::dds

namespace stillhand::runtime {

/// Whose certificate and permissions a participant shows, from a folder written by
/// deploy/security/make.sh.
struct Identity {
  std::filesystem::path folder;  ///< empty: no security
  std::string name;              ///< one of topics::kServices, topics::kDashboard or kTap

  /// That of a service or of a dashboard; of anything else topics::kTap.
  static Identity of(const std::filesystem::path& folder, const std::string& service);
  [[nodiscard]] bool none() const { return folder.empty(); }
};

/// Checks every file of the identity, since Fast DDS ignores some faults and answers others with a
/// null participant and no reason.
/// @throws ConfigError for a file that is missing, a certificate that is expired, not yet valid or
/// of another authority, another certificate's key or one that every user can read, documents that
/// this authority did not sign or that are another subject's, and a domain they are not made for.
void check_identity(const Identity& identity, std::uint32_t domain);

/// A warning for the operator when the certificate expires within 30 days; else empty.  A running
/// session does not notice the end of a certificate.  @throws ConfigError when it cannot be read
std::string expiry_warning(const Identity& identity);

/// Sets the DDS Security properties, and discovery by initial peers on the loopback where the
/// profile has none.  @throws ConfigError for a discovery server, by profile or environment: it
/// hands secured samples to unsecured clients (Fast DDS 2.9.1); for multicast on another address
/// and for a profile with several receiving threads: some participants would not authenticate.
void secure(eprosima::fastdds::dds::DomainParticipantQos& qos, const Identity& identity);

/// The participant authenticates as `identity`.  Fast DDS ignores a misspelt property and runs
/// without security; but where its authentication runs, it makes the first 6 bytes of the
/// GUID from the certificate's subject (DDS Security 1.1, 9.3.3.1).  Without access control or
/// cryptography no endpoint would match it, which every session reports.
bool is_secured(const eprosima::fastdds::dds::DomainParticipant& participant,
                const Identity& identity);

}  // namespace stillhand::runtime
