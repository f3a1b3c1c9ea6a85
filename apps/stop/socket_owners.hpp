// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>

namespace stillhand::stop {

/// The user of each Unix socket of this machine, by the socket's inode, as the kernel knows it
/// (sock_diag(7)).  Empty where the kernel does not say: before Linux 5.3, or without unix_diag.
std::map<std::uint64_t, uid_t> socket_owners();

}  // namespace stillhand::stop
