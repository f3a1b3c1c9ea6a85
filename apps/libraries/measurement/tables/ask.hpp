// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "apps/libraries/measurement/tables/mapping.hpp"
#include "apps/libraries/measurement/tables/table_file.hpp"

namespace stillhand::measurement {

/// Asks a person which columns are the time, the acceleration and the force, and for further
/// channels.  Enter takes what is proposed.  A wrong answer is asked for again.
/// @throws stillhand::ConfigError when the answers end before the last question
Mapping ask_mapping(TableFile& file, std::istream& in, std::ostream& out);

}  // namespace stillhand::measurement
