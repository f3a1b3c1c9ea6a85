// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace stillhand::support {

/// A DDS domain, 100 to 159, that no other test program on this machine has: a lock on a file of
/// that number, held until the process ends.  Labs and integration tests use others.
inline std::uint32_t own_domain() {
  static const std::uint32_t domain = [] {
    const auto folder = std::filesystem::temp_directory_path();
    for (std::uint32_t i = 100; i < 160; ++i) {
      const auto file = folder / ("stillhand-test-domain-" + std::to_string(i));
      const int fd = ::open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
      if (fd < 0) continue;
      if (::flock(fd, LOCK_EX | LOCK_NB) == 0) return i;
      ::close(fd);
    }
    throw std::runtime_error("no DDS domain from 100 to 159 is free");
  }();
  return domain;
}

}  // namespace stillhand::support
