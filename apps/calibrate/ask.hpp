// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/runtime/process/stop.hpp"

namespace stillhand::calibrate {

/// Asks a person for a step and waits for Enter.  What was typed before is no answer.
/// @returns false at the end of standard input, or after an interrupt
bool done_by_person(const std::string& step, const runtime::Stop& interrupted);

}  // namespace stillhand::calibrate
