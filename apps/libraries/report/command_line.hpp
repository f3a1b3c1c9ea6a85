// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::report {

/// Command line of this program, such as "stillhand study --seed 1", for the facts of a report: it
/// can be pasted into a shell.
std::string command_line();

/// A word as a POSIX shell reads it back: in single quotes if it needs them.
std::string quoted_for_shell(const std::string& word);
/// The same, always in single quotes.
std::string in_shell_quotes(std::string word);

}  // namespace stillhand::report
