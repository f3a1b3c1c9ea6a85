// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace stillhand::runtime {

/// "stillhand lab" of the bytes of /proc/self/cmdline, in which each word ends in a NUL: the
/// program and the verb that was typed.  "stillhand" where the first word is an option, or none was
/// typed.
std::string prefix_of(std::string_view command_line);

/// One line on standard error, behind program and verb: "stillhand lab: TEXT".  The verb is the one
/// that was typed, whichever part of the program speaks.
void remark(std::string_view text);

}  // namespace stillhand::runtime
