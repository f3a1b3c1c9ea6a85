// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/system/command_line/command_line.hpp"

/// What `stillhand`, `stillhand help VERB` and `stillhand VERB --help` print.
namespace stillhand {

/// Gives the program and each of its verbs the help texts of this folder.  Call after the verbs are
/// added.  A verb with many options shows the first group of them; --help-all shows all.
/// @throws std::logic_error for a verb that the overview does not know
void add_help(command_line::Program& cli);

/// "stillhand help lab" is "stillhand lab --help", and "stillhand help" is "stillhand --help".
/// @param words  of the command line, without the program
std::vector<std::string> without_help_verb(std::vector<std::string> words);

/// Why the first word is no verb and which one is meant, in one line; empty: it is one, or an
/// option, or there is none.
std::string misspelt_verb(const std::vector<std::string>& words);

/// One line for a command line that did not end well: the word that is neither an option nor a verb
/// of its verb, and which is meant; without one `what`, and whose help to read.
std::string usage_error(const command_line::Program& cli, const std::string& what);

}  // namespace stillhand
