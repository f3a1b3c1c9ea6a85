// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::runtime {

/// One process of this machine has a name.  An abstract socket is the lock: it is gone however the
/// process ends.  Each network namespace has names of its own.
class HostLock {
 public:
  /// @param name  of the lock, at most 90 characters
  /// @throws ConfigError of these three when another process has it
  HostLock(const std::string& name, const std::string& what,
           const std::string& got = "another process of this machine has it",
           const std::string& want = "one process for it");
  ~HostLock();
  HostLock(const HostLock&) = delete;
  HostLock& operator=(const HostLock&) = delete;

 private:
  int socket_;
};

}  // namespace stillhand::runtime
