// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "apps/libraries/measurement/session.hpp"
#include "services/core/contract/trial.hpp"

namespace stillhand::measurement {

/// Reads a trial that has just ended from the file that the recorder still writes; the file may be
/// a second behind, so this waits, at most 7 s, with ordinary priority.
/// @param tracking  the trial has target and cursor
/// @throws std::runtime_error when less than 98 % of the trial's ticks are there in time
SessionRows written_trial(const std::filesystem::path& file, const Trial& trial, bool tracking);

}  // namespace stillhand::measurement
