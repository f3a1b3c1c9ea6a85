// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace stillhand::lab {

/// Looks at the keys of services on this machine before anything starts; a certificate that ends
/// soon is told on standard error.
/// @param folder  that deploy/security/make.sh wrote; empty: no security
/// @throws ConfigError
void check_keys(const std::filesystem::path& folder, std::uint32_t domain,
                const std::vector<std::string>& services);

/// A shell's script that fails, and says why, unless the keys of services are there and of the
/// same authority.
/// @param folder     there
/// @param authority  text of the certificate
std::string keys_script(const std::filesystem::path& folder, const std::string& authority,
                        const std::vector<std::string>& services);

}  // namespace stillhand::lab
