// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/libraries/measurement/tables/mapping.hpp"
#include "apps/libraries/measurement/tables/table_file.hpp"

namespace stillhand::measurement {

/// A mapping that would do for a file whose titles are no names of channels: what the titles
/// resemble, then what is still missing.  For a person to correct.
Mapping suggestion(TableFile& file);

/// "if they are these, add --map ...": the suggestion ready for a shell.
std::string words_to_add(TableFile& file);

/// @throws stillhand::ConfigError, always, with the suggestion ready for a shell
[[noreturn]] void refuse_titles(TableFile& file);

}  // namespace stillhand::measurement
