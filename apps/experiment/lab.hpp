// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "experiment/protocol.hpp"
#include "recording/keep_options.hpp"
#include "runtime/stop.hpp"

namespace stillhand::experiment {

/// Who tracks the target.
enum class Operator : std::uint8_t { kSimulated, kMouse };

/// `stillhand lab`: everything the command line says.
struct LabOptions {
  ProtocolOptions protocol;
  std::filesystem::path out;       ///< folder of the results
  std::filesystem::path ride;      ///< recorded ride, for Motion::kRide
  std::filesystem::path programs;  ///< folder of the stillhand-* executables
  std::filesystem::path profiles;  ///< qos/profiles.xml
  std::filesystem::path config;    ///< folder of the services' settings
  std::uint32_t domain = 0;
  std::uint32_t rig = 1;
  bool headless = false;
  bool video = false;     ///< headless display writes DIR/screen.avi
  bool real_time = true;  ///< ask for a real-time scheduling policy
  Operator who = Operator::kSimulated;
  std::uint64_t undeclared_effect = 0;  ///< seed of what only the rig is told of; 0: nothing
  double match_s = 20.0;                ///< [s] patience until every endpoint has matched
  recording::KeepOptions keep;          ///< of the session's recording
};

/// Runs a whole session on this machine: starts every process, identifies, runs the trials over
/// DDS, records, computes the results from the recording, stops every process.
/// @return exit status: 0 when every trial was completed, 1 otherwise.
/// @throws ConfigError for what the user can mend before the run.
int run_lab(const LabOptions& options, runtime::Stop& stop);

}  // namespace stillhand::experiment
