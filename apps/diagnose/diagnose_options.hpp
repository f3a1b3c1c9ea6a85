// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/libraries/measurement/read_options.hpp"
#include "services/core/diagnosis/diagnose.hpp"

namespace stillhand::command_line {
class Command;
}

namespace stillhand::diagnose {

/// Adds what a verb diagnoses: REC..., --input, --output, --trial, and how files are read.
/// @param recordings, read, options  keep what the user gives
void add_recordings(command_line::Command& verb, std::vector<std::string>& recordings,
                    measurement::ReadOptions& read, diagnosis::DiagnoseOptions& options);

/// Each of them, with the channels that the options name.
/// @throws stillhand::ConfigError as read_measurement()
std::vector<diagnosis::Measurement> read_recordings(const std::vector<std::string>& recordings,
                                                    measurement::ReadOptions read,
                                                    const diagnosis::DiagnoseOptions& options);

/// Adds the options that decide a verdict (--model, --order, --most-effects, --least-force) to a
/// verb.  Every verb that diagnoses takes them from here, so that one file has one verdict.
/// @param options  keeps what the user gives; as it comes it holds the defaults
void add_diagnose_options(command_line::Command& verb, diagnosis::DiagnoseOptions& options);

}  // namespace stillhand::diagnose
