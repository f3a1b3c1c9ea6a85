// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::report {

/// Command line of this program, such as "stillhand study --seed 1", for the facts of a report.
std::string command_line();

}  // namespace stillhand::report
