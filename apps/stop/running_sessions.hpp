// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <istream>
#include <vector>

namespace stillhand::stop {

/// A session that a lab of this machine conducts.
struct RunningSession {
  std::uint32_t domain = 0;
  std::uint32_t rig = 1;
  bool operator==(const RunningSession&) const = default;
};

/// The sessions whose locks (lab/domain_lock.hpp) are among a machine's sockets, each once, in the
/// order of their domains.
/// @param sockets  text of /proc/net/unix
std::vector<RunningSession> running_sessions(std::istream& sockets);

}  // namespace stillhand::stop
