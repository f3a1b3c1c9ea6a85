// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/system/process/host_lock.hpp"

namespace stillhand::lab {

/// Admits one lab for each domain and rig on this machine.
class DomainLock {
 public:
  /// @throws ConfigError when another lab holds the lock, or another program the domain's
  ///         discovery port: the processes of the session would not discover each other.
  DomainLock(std::uint32_t domain, std::uint32_t rig);

 private:
  runtime::HostLock lock_;
};

}  // namespace stillhand::lab
