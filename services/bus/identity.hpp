// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

namespace stillhand::runtime {

/// Whose certificate and permissions a participant shows, from a folder written by
/// deploy/security/make.sh.
struct Identity {
  std::filesystem::path folder;  ///< empty: no security
  std::string name;              ///< one of topics::kServices, topics::kDashboard or kTap

  /// That of a service or of a dashboard; of anything else topics::kTap.
  static Identity of(const std::filesystem::path& folder, const std::string& service);
  [[nodiscard]] bool none() const { return folder.empty(); }

  [[nodiscard]] std::filesystem::path authority_file() const;   ///< its certificate
  [[nodiscard]] std::filesystem::path governance_file() const;  ///< signed by the authority
  /// "certificate.pem", "key.pem" or "permissions.p7s"
  [[nodiscard]] std::filesystem::path own_file(const char* file) const;
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

/// First 6 bytes of the GUID of a participant that authenticates as this identity, made from the
/// certificate's subject (DDS Security 1.1, 9.3.3.1).  @throws ConfigError when it cannot be read
std::array<std::uint8_t, 6> guid_start(const Identity& identity);
/// The same of another identity of the same lab, whose certificate need not be on this machine: the
/// subjects of a lab differ in their common name alone.
std::array<std::uint8_t, 6> guid_start(const Identity& identity, const std::string& name);

}  // namespace stillhand::runtime
