// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/keys.hpp"

#include <fmt/format.h>

#include "apps/lab/remote.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "services/bus/identity.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::lab {

void check_keys(const std::filesystem::path& folder, std::uint32_t domain,
                const std::vector<std::string>& services) {
  if (folder.empty()) return;
  for (const std::string& service : services) {
    const auto identity = runtime::Identity::of(folder, service);
    runtime::check_identity(identity, domain);
    const std::string warning = runtime::expiry_warning(identity);
    if (!warning.empty()) runtime::remark(warning);
  }
}

// The private keys stay on their host: each service checks its own when it starts.
std::string keys_script(const std::filesystem::path& folder, const std::string& authority,
                        const std::vector<std::string>& services) {
  std::string files = "authority.pem governance.p7s";
  for (const std::string& service : services) {
    for (const char* file : {"/certificate.pem", "/key.pem", "/permissions.p7s"}) {
      files += fmt::format(" {}{}", service, file);
    }
  }
  // $( ) drops newlines at the end: a copy of the certificate may lack its last one.
  return fmt::format(
      "cd {} || exit 1\n"
      "for file in {}; do\n"
      "  [ -r $file ] || {{ echo \"no $PWD/$file to read\"; exit 1; }}\n"
      "done\n"
      "[ \"$(cat authority.pem)\" = \"$(cat {})\" ] || "
      "{{ echo \"$PWD/authority.pem is another\"; exit 1; }}\n",
      report::in_shell_quotes(folder.string()), files, here_document(authority));
}

}  // namespace stillhand::lab
