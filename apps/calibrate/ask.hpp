// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/system/process/stop.hpp"

namespace stillhand::calibrate {

/// A push or a motion is confirmed by a person who sees it, not by `yes |` or a file.
/// @throws ConfigError when standard input is no terminal
void want_terminal();

/// Asks a person for a step and waits for Enter.  What was typed before is no answer.
/// @returns false at the end of the terminal's input, or after an interrupt
bool done_by_person(const std::string& step, const runtime::Stop& interrupted);

}  // namespace stillhand::calibrate
