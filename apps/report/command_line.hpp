// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::report {

/// How this program was called, "stillhand study --seed 1", for a report's facts.
std::string command_line();

}  // namespace stillhand::report
