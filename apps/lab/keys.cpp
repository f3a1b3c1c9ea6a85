// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/keys.hpp"

#include <iostream>

#include "apps/lab/remote.hpp"
#include "services/runtime/bus/security.hpp"

namespace stillhand::lab {

void check_keys(const std::filesystem::path& folder, std::uint32_t domain,
                const std::vector<std::string>& services) {
  if (folder.empty()) return;
  for (const std::string& service : services) {
    const auto identity = runtime::Identity::of(folder, service);
    runtime::check_identity(identity, domain);
    const std::string warning = runtime::expiry_warning(identity);
    if (!warning.empty()) std::cerr << "stillhand lab: " << warning << '\n';
  }
}

// The private keys stay there, so each service looks at its own itself, when it starts.
std::string keys_script(const std::filesystem::path& folder, const std::string& authority,
                        const std::vector<std::string>& services) {
  std::string script = "cd " + shell_word(folder.string()) + " || exit 1\n";
  std::string files = "authority.pem governance.p7s";
  for (const std::string& service : services) {
    for (const char* file : {"/certificate.pem", "/key.pem", "/permissions.p7s"}) {
      files += " " + service + file;
    }
  }
  script += "for file in " + files + "; do\n" +
            "  [ -r $file ] || { echo \"no $PWD/$file to read\"; exit 1; }\n" + "done\n";
  // Between $( and ), which leave out the ends of lines at the end: a copy may lack its last.
  return script + "[ \"$(cat authority.pem)\" = \"$(cat " + here_document(authority) +
         ")\" ] || { echo \"$PWD/authority.pem is another\"; exit 1; }\n";
}

}  // namespace stillhand::lab
