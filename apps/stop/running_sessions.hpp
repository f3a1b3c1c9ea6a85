// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <compare>
#include <cstdint>
#include <istream>
#include <map>
#include <vector>

namespace stillhand::stop {

/// A session that a lab of this machine conducts.
struct RunningSession {
  std::uint32_t domain = 0;
  std::uint32_t rig = 1;
  auto operator<=>(const RunningSession&) const = default;
};

/// The sessions whose locks (lab/domain_lock.hpp) are among a machine's sockets, each once. Anybody
/// may claim any number of sessions, so users take turns: the first session of each, the second of
/// each, ...; in each turn, and of one user, in the order of their domains.
/// @param sockets  text of /proc/net/unix
/// @param owners  socket_owners()
std::vector<RunningSession> running_sessions(std::istream& sockets,
                                             const std::map<std::uint64_t, uid_t>& owners);

}  // namespace stillhand::stop
