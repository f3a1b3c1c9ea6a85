// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace stillhand::runtime {

/// qos/profiles.xml of an installed prefix, or of the source tree the program was built from.
inline std::filesystem::path find_profiles(const char* source) {
  const auto programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  for (const std::filesystem::path& root :
       {programs.parent_path() / "share" / "stillhand", std::filesystem::path(source)}) {
    if (std::filesystem::exists(root / "qos" / "profiles.xml")) {
      return root / "qos" / "profiles.xml";
    }
  }
  return "qos/profiles.xml";
}

}  // namespace stillhand::runtime
