// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace stillhand::report {

/// Command line of this program, such as "stillhand study --seed 1", for the facts of a report: it
/// can be pasted into a shell.
std::string command_line();

/// A word as a POSIX shell reads it back: in single quotes if it needs them.
std::string quoted_for_shell(const std::string& word);
/// The same, always in single quotes.
std::string in_shell_quotes(std::string word);

/// What a person may type or open next, in a line of its own, on a terminal alone.
void say_next(const std::string& step);
/// The same, to open a page or picture.
void say_open(const std::filesystem::path& file);
/// "report in FOLDER", and next to open its page.
void say_report(const std::filesystem::path& folder);

}  // namespace stillhand::report
