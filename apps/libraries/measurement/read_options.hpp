// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/libraries/measurement/read.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::measurement {

/// Adds the options for recordings of other programs to a verb: --map, --map-file, --sample-rate,
/// --separator, --decimal.  `options` must outlive the parsing.  On a terminal, a --map-file that
/// is not there is asked for.
/// @returns the options that were added
std::vector<command_line::Option> add_read_options(command_line::Command& verb,
                                                   ReadOptions& options);

/// Adds what a verb of one recording reads: REC, --trial, and how files are read.
void add_recording_options(command_line::Command& verb, std::string& recording,
                           ReadOptions& options);

/// Adds --heaviest, for a machine in place of a hand.  @param heaviest_kg  must outlive the parsing
void add_heaviest_option(command_line::Command& verb, double& heaviest_kg);

/// The columns and the rate as the command line of a further verb states them, with a blank before
/// each; empty: nothing was stated.
std::string words_of(const ReadOptions& options);

/// @param names   channels that the verb can't do without
/// @param where   options that state them; empty: none
/// @throws stillhand::ConfigError for one that the recording lacks, with those that it has and, of
///         a table without a mapping, the --map that may help.
void require_channels(const diagnosis::Measurement& measurement,
                      const std::vector<std::string>& names, const ReadOptions& options,
                      const std::string& where = {});

/// What to do next where a recording gives no model.
/// @param reason  of diagnosis::NoModel
std::string step_for(const std::string& reason);

}  // namespace stillhand::measurement
