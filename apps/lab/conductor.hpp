// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>

#include "apps/lab/core/seen.hpp"
#include "apps/lab/core/stage.hpp"
#include "apps/lab/core/trouble.hpp"
#include "apps/lab/processes.hpp"
#include "apps/libraries/session/protocol.hpp"
#include "apps/libraries/session/trial_outcome.hpp"
#include "idl/model.h"
#include "idl/session.h"
#include "services/bus/emergency_stop.hpp"
#include "services/bus/service.hpp"
#include "services/core/cancellation/control_model.hpp"

namespace stillhand::lab {

struct TrialResult;

/// A process of the session refused what the user gave it; the text is the process's own line.
/// Exit status 2.
class RefusedByProcess : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The "experiment" role on the bus: announces trials and follows every process's status and
/// events.  The shell of core/: bus callbacks store what comes, under a mutex; one thread calls
/// the functions below, which step a stage of the session and perform its actions with no lock
/// held.
class Conductor {
 public:
  /// Looks for a process that ended; nothing when all run.
  using Watch = std::function<std::optional<Ended>()>;
  /// Called about ten times a second while something runs.
  using Show = std::function<void(const Progress&)>;
  /// Called once with what the person at the terminal should know while the trial runs.
  using Say = std::function<void(const std::string&)>;

  /// @param say  nothing: a blinded session
  Conductor(runtime::Service& service, Watch watch, Show show, Say say);

  /// Returns once every endpoint of the catalogue has matched.
  /// @throws std::runtime_error naming the processes that are missing after `limit_s` [s];
  ///         RefusedByProcess.
  void await_everybody(double limit_s);
  /// The sample clock starts.
  /// @throws std::runtime_error when it does not; RefusedByProcess.
  void begin_session();
  /// No trial begins before a request for a start.
  void pause();
  /// What the participant's screen shows from now on.
  void show(const Prompt& prompt);
  /// Shows it and waits for the answer.  @return nothing: none came
  /// @throws std::runtime_error, RefusedByProcess
  std::optional<std::int64_t> ask(const Prompt& prompt, const std::string& what);
  /// Waits, at most that long; a request for a start ends it.
  /// @param over  ends it too, where there is one
  void rest(const std::string& what, double seconds, const std::function<bool()>& over);
  /// An event of the session, for the recording.
  void note(const std::string& text) {
    service_.note_event(stillhand_msgs::EVENT_NOTE, text.c_str());
  }
  /// What persons asked of the protocol since the last call.
  Asked asked();
  /// Waits for the end of a pause, then runs one trial to its end, or until something breaks it.
  session::TrialOutcome run(const session::PlannedTrial& planned);

  /// The model of a pegged trial.
  struct AwaitedModel {
    stillhand_msgs::FeedthroughModel model;  ///< where `failure` is empty
    std::string failure;                     ///< why there is no usable model, or empty
  };
  AwaitedModel await_model(std::int64_t trial);
  /// Gives the canceller a model and waits for its answer.  @return why it was refused, or empty
  std::string use(const cancellation::ControlModel& model);
  /// Path of the recording on the recorder's own host; empty: the recorder did not report it.
  [[nodiscard]] std::string recording();
  /// Misses no longer count; processes may leave.
  void end_session();
  /// Asks the rig for an emergency stop; from one thread, which may be another.
  void stop_at_once() { emergency_stop_.ask(); }
  /// True once the user asked to stop.
  [[nodiscard]] bool interrupted() const noexcept { return service_.stop().requested(); }

 private:
  void subscribe();
  /// Steps the stage until it is over.
  void run_stage(Stage& stage, bool with_peers = false);
  void look(bool with_peers);
  /// The interlock opened, and nobody asked for it.
  bool was_late(const TrialResult& result);
  /// What the watch on the model has found since the last call.
  void say_model_changes();
  /// Announces who writes for each process, once.
  void name_sources();
  void repeat_sources();
  void perform(const Actions& actions);
  void announce(const Announcement& announcement);
  /// @throws RefusedByProcess or std::runtime_error when there is trouble.
  void throw_trouble() const;

  runtime::Service& service_;
  Watch watch_;
  Show show_;
  Say say_;
  Roster roster_;
  runtime::Publisher<stillhand_msgs::TrialControl> control_;
  runtime::Publisher<stillhand_msgs::TrialAssignment> assignment_;
  runtime::Publisher<stillhand_msgs::AugmentedModel> control_model_;
  runtime::Publisher<stillhand_msgs::SessionSources> sources_;
  std::optional<stillhand_msgs::SessionSources> named_sources_;
  runtime::Publisher<stillhand_msgs::Prompt> prompts_;
  std::uint64_t shown_ = 0;  ///< prompts so far; the number of the newest
  runtime::EmergencyStop emergency_stop_;
  std::optional<session::PlannedTrial> planned_;  ///< the trial that runs
  stillhand_msgs::AugmentedModel given_;          ///< the model that the canceller gets
  std::int32_t models_ = 0;                       ///< control models given so far
  Trouble trouble_;

  std::mutex mutex_;  ///< guards what follows
  std::condition_variable news_;
  bool fresh_ = false;  ///< something came since the last step
  Seen seen_;
  stillhand_msgs::FeedthroughModel model_;  ///< the newest
  std::string recording_;
  std::vector<session::Mark> model_changes_;  ///< not yet said
};

}  // namespace stillhand::lab
