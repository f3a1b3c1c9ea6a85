// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillhand::lab {

/// Admits one lab for each domain and rig on this machine.  An abstract socket name is the lock: it
/// is gone however the process ends.
class DomainLock {
 public:
  /// @throws ConfigError when another lab holds the lock, or another program the domain's
  ///         discovery port: the processes of the session would not discover each other.
  DomainLock(std::uint32_t domain, std::uint32_t rig);
  ~DomainLock();
  DomainLock(const DomainLock&) = delete;
  DomainLock& operator=(const DomainLock&) = delete;

 private:
  int socket_;
};

}  // namespace stillhand::lab
