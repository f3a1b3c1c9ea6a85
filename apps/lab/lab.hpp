// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/lab/conductor.hpp"
#include "apps/session/protocol.hpp"
#include "services/cancellation/core/control_model.hpp"
#include "services/identification/core/identifier.hpp"
#include "services/recording/keep_options.hpp"
#include "services/runtime/process/stop.hpp"

namespace stillhand::lab {

/// Who tracks the target.
enum class Operator : std::uint8_t { kSimulated, kMouse };

/// `stillhand lab`: everything the command line says.
struct LabOptions {
  session::ProtocolOptions protocol;
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
  std::filesystem::path security;       ///< folder of keys; empty: none, or the inventory's
  std::filesystem::path inventory;      ///< the lab's machines; empty: this one
  std::filesystem::path model;          ///< control model for C; empty: the session's own
  std::uint64_t undeclared_effect = 0;  ///< seed of what only the rig is told of; 0: nothing
  double match_s = 20.0;                ///< [s] patience until every endpoint has matched
  bool attach = false;                  ///< to services that somebody else has started
  bool wait_for_start = false;          ///< each trial waits for a start from the dashboard
  recording::KeepOptions keep;          ///< of the session's recording
};

/// Sets programs, profiles and config: those of the build tree or of an installed prefix.
void set_places(LabOptions& options);

/// A control model from a file, as the canceller would take it.
/// @param config  folder of the services' settings
/// @throws ConfigError when it isn't one, is of another rig, or the canceller would refuse it
cancellation::ControlModel control_model(const std::filesystem::path& file, std::uint32_t rig,
                                         const std::filesystem::path& config);

/// A session over DDS while its processes run: trial by trial.
class LiveTrials {
 public:
  virtual ~LiveTrials() = default;
  /// Runs one trial; of a pegged one, to the model that it gives.  One that somebody stops is run
  /// again once a start is asked for, under a number of its own: the outcome's.  A trial that isn't
  /// completed ends the session: run nothing behind it.
  virtual const session::TrialOutcome& run(const session::PlannedTrial& planned) = 0;
  /// The model identified last.
  [[nodiscard]] virtual const identification::FeedthroughModel& model() const = 0;
  /// Gives the canceller a model.  @return why it wasn't taken, or empty
  virtual std::string use(const cancellation::ControlModel& model) = 0;
  [[nodiscard]] virtual bool interrupted() const = 0;
};

/// What happens in a session, between the processes' start and their end.
using Script = std::function<void(LiveTrials& trials)>;

class OutputFolder;

/// What is left of a session whose processes have ended.
struct LiveSession {
  std::vector<session::TrialOutcome> outcomes;
  bool interrupted = false;
  std::string sealed;                    ///< for open_undeclared_effect()
  std::shared_ptr<OutputFolder> folder;  ///< its own as long as this lives
};

/// Starts every process, runs the script, ends every process.  The recording is DIR/session.mcap.
/// @throws ConfigError for what the user can mend before the run; what the script throws
LiveSession run_session(const LabOptions& options, runtime::Stop& stop, const Script& script);

/// DIR/undeclared_effect.json, once the verdict is there.  @param verdict  a file in DIR
void open_undeclared_effect(const LabOptions& options, const std::string& sealed,
                            const std::string& verdict);

/// Runs a whole session from this machine: starts every process, identifies, runs the trials over
/// DDS, records, computes the results from the recording, stops every process.
/// @return exit status: 0 when every trial was completed, 1 otherwise.
/// @throws ConfigError for what the user can mend before the run.
int run_lab(const LabOptions& options, runtime::Stop& stop);

}  // namespace stillhand::lab
