// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace stillhand::runtime {

/// Where the running program is installed: /usr, for example, or a build tree, which has the same
/// layout (deploy/debian/CMakeLists.txt).
inline std::filesystem::path prefix() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path();
}

/// A file or folder that comes with the programs, by its place in the source tree:
/// qos/profiles.xml, deploy/config.
inline std::filesystem::path shipped(const char* file) {
  return prefix() / "share" / "stillhand" / file;
}

}  // namespace stillhand::runtime
