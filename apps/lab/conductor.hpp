// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/lab/processes.hpp"
#include "apps/lab/requests.hpp"
#include "apps/session/protocol.hpp"
#include "apps/session/trial_outcome.hpp"
#include "idl/model.h"
#include "idl/session.h"
#include "services/cancellation/core/control_model.hpp"
#include "services/runtime/service.hpp"

namespace stillhand::lab {

/// A process of the session refused what the user gave it; its own line says what.  Exit status 2.
class RefusedByProcess : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The "experiment" role on the bus: announces trials, follows everybody's status and events.  Used
/// from one thread; bus callbacks only store what came.
class Conductor {
 public:
  /// Looks for a process that ended; nothing when all run.
  using Watch = std::function<std::optional<Ended>()>;
  /// Called about ten times a second while something runs; done in [0, 1].
  using Progress = std::function<void(const std::string& what, double done)>;

  Conductor(runtime::Service& service, Watch watch, Progress progress);

  /// Returns once every endpoint of the catalogue has matched.
  /// @throws std::runtime_error naming who did not come within `limit_s` [s]; RefusedByProcess.
  void await_everybody(double limit_s);
  /// The sample clock starts.
  void begin_session();
  /// No trial begins before somebody asks for a start.
  void pause();
  /// Waits for the end of a pause, then runs one trial to its end, or until something breaks it.
  session::TrialOutcome run(session::PlannedTrial planned);
  /// The model identified from a trial, or nothing when none comes within `limit_s` [s].
  std::optional<stillhand_msgs::FeedthroughModel> await_model(std::int64_t trial, double limit_s);
  /// Gives the canceller a model and waits for its answer.  @return why it wasn't taken, or empty
  std::string use(const cancellation::ControlModel& model);
  /// A process that ended, an emergency stop, "interrupted", or else `otherwise`.
  [[nodiscard]] std::string why_stopped(const std::string& otherwise) const;
  /// Where the recorder says that its file is, on its own host; empty: it did not.
  [[nodiscard]] std::string recording();
  /// Misses no longer count; processes may leave.
  void end_session();
  /// True once the user asked to stop.
  [[nodiscard]] bool interrupted() const noexcept { return service_.stop().requested(); }

 private:
  struct Seen {
    std::map<std::string, stillhand_msgs::ServiceStatus> statuses;
    std::vector<stillhand_msgs::Event> events;
    std::optional<stillhand_msgs::FeedthroughModel> model;
    std::string recording;
    Requests requests;
    bool trial_runs = false;
  };

  /// Waits until `done(seen)` holds.  @return false after `limit_s`, on trouble or on a stop.
  bool wait_for(double limit_s, const std::function<bool(Seen&)>& done);
  void take_requests();
  /// Waits out a pause and begins the trial.  @param before  the misses until then
  bool await_start(const session::PlannedTrial& planned, session::MissCounts& before);
  void announce(const session::PlannedTrial* planned, stillhand_msgs::SessionState session);
  void assign(const session::PlannedTrial& planned);
  [[nodiscard]] Tick newest_tick();
  /// @throws RefusedByProcess or std::runtime_error when a process ended.
  void throw_trouble() const;
  [[nodiscard]] std::vector<std::string> absent(const Seen& seen) const;
  bool await_armed(const session::PlannedTrial& planned, session::TrialOutcome& outcome);
  void follow(const session::PlannedTrial& planned, session::TrialOutcome& outcome);
  [[nodiscard]] static std::string why_not_armed(const Seen& seen, std::string_view service);
  void see_force_out(bool completed);
  void look_for_death(session::TrialOutcome& outcome);
  void collect(session::TrialOutcome& outcome, const session::MissCounts& before);
  [[nodiscard]] static session::MissCounts count(const Seen& seen);

  runtime::Service& service_;
  Watch watch_;
  bool silent_ = false;  ///< the trouble is a process's silence: it may still be there
  Progress progress_;
  runtime::Publisher<stillhand_msgs::TrialControl> control_;
  runtime::Publisher<stillhand_msgs::TrialAssignment> assignment_;
  runtime::Publisher<stillhand_msgs::AugmentedModel> control_model_;
  std::int32_t models_ = 0;  ///< control models published
  std::mutex mutex_;
  std::condition_variable news_;
  Seen seen_;
  std::string trouble_;    ///< a process that ended, an emergency stop, or empty
  bool mendable_ = false;  ///< it said that the user can mend it
};

}  // namespace stillhand::lab
