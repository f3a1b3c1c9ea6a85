// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/libraries/measurement/read.hpp"

namespace stillhand::measurement {

/// Adds the options for recordings of other programs to a verb: --map, --map-file, --sample-rate,
/// --separator, --decimal.  `options` must outlive the parsing.  On a terminal, a --map-file that
/// is not there is asked for.
/// @returns the options that were added
std::vector<CLI::Option*> add_read_options(CLI::App& verb, ReadOptions& options);

/// The columns and the rate as the command line of a further verb states them, with a blank before
/// each; empty: nothing was stated.
std::string words_of(const ReadOptions& options);

}  // namespace stillhand::measurement
