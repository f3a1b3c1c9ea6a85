// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "services/runtime/process/stop.hpp"

namespace stillhand::stop {

/// The command line of `stillhand stop`.
struct StopOptions {
  std::optional<std::uint32_t> domain;  ///< nothing: every session that a lab of this machine runs
  std::optional<std::uint32_t> rig;     ///< nothing: those of the labs here, or 1
  std::filesystem::path profiles;       ///< qos/profiles.xml
  std::filesystem::path security;       ///< folder of keys; empty: none
  double wait_s = 10.0;                 ///< [s] for the rigs' answers
};

/// Asks the rigs for an emergency stop and prints a line for each.
/// @returns exit status: 0 when every rig reported that its force is zero, otherwise 1
int run_stop(const StopOptions& options, const runtime::Stop& interrupted);

}  // namespace stillhand::stop
