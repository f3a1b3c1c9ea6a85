// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace stillhand::lab {

/// Checks the keys of services on this machine before anything starts, and warns on standard error
/// of a certificate that expires soon.
/// @param folder  that deploy/security/make.sh wrote; empty: no security
/// @throws ConfigError
void check_keys(const std::filesystem::path& folder, std::uint32_t domain,
                const std::vector<std::string>& services);

/// A shell script that fails and prints why, unless the keys of the services exist and are of the
/// same authority.
/// @param folder     on the host that runs the script
/// @param authority  text of the certificate
std::string keys_script(const std::filesystem::path& folder, const std::string& authority,
                        const std::vector<std::string>& services);

}  // namespace stillhand::lab
