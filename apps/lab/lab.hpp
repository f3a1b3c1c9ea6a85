// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/lab/lab_options.hpp"
#include "apps/lab/live_trials.hpp"
#include "apps/libraries/session/trial_outcome.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::lab {

class OutputFolder;

/// What a session leaves when its processes have ended.
struct LiveSession {
  std::vector<session::TrialOutcome> outcomes;
  bool interrupted = false;
  std::string sealed;                    ///< for open_undeclared_effect()
  std::filesystem::path config;          ///< settings of its services
  std::shared_ptr<OutputFolder> folder;  ///< keeps the folder from other labs as long as this lives
};

/// Starts every process, runs the script, ends every process.  The recording is DIR/session.mcap.
/// @throws ConfigError for what the user can mend before the run; what the script throws
LiveSession run_session(const LabOptions& options, runtime::Stop& stop, const Script& script);

/// Runs a whole session from this machine: starts every process, identifies, runs the trials over
/// DDS, records, computes the results from the recording, stops every process.
/// @return exit status: 0 when every trial was completed, 1 otherwise.
/// @throws ConfigError for what the user can mend before the run.
int run_lab(const LabOptions& options, runtime::Stop& stop);

}  // namespace stillhand::lab
