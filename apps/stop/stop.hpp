// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "apps/stop/running_sessions.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::stop {

/// The command line of `stillhand stop`.
struct StopOptions {
  std::optional<std::uint32_t> domain;  ///< nothing: every session that a lab of this machine runs
  std::optional<std::uint32_t> rig;     ///< nothing: those of the labs here, or 1
  std::filesystem::path profiles;       ///< qos/profiles.xml
  std::filesystem::path security;       ///< folder of keys; empty: none
  double wait_s = 10.0;                 ///< [s] for the rigs' answers
};

/// Asks the rig of each session for an emergency stop, as soon as it can be asked, and prints a
/// line for each.  A session that cannot be asked keeps no other from it: anybody may claim one.
/// @returns exit status: 0 when every rig reported that its force is zero, otherwise 1
/// @throws what kept it from asking, when no session could be asked
int stop_sessions(std::span<const RunningSession> sessions, const StopOptions& options,
                  const runtime::Stop& interrupted);

/// stop_sessions() of those that are running.
int run_stop(const StopOptions& options, const runtime::Stop& interrupted);

}  // namespace stillhand::stop
