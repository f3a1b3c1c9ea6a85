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

#include "cancellation/core/augmented_model.hpp"
#include "experiment/marks.hpp"
#include "experiment/processes.hpp"
#include "experiment/protocol.hpp"
#include "experiment/requests.hpp"
#include "idl/model.h"
#include "idl/session.h"
#include "motion/core/motion_trajectory.hpp"
#include "runtime/service.hpp"

namespace stillhand::experiment {

/// Misses that every reader counted since the session began.
struct MissCounts {
  std::int64_t deadline = 0;  ///< DDS's count
  std::int64_t cycle = 0;     ///< own microsecond supervision
  std::int64_t lost_ticks = 0;
};

/// How a trial went.
struct TrialOutcome {
  PlannedTrial planned;
  bool completed = false;
  bool stopped = false;                       ///< somebody asked for its end: it is run again
  std::string aborted;                        ///< why it was not completed, or empty
  std::vector<Mark> marks;                    ///< events during the trial, in order of their first
  MissCounts misses;                          ///< during the trial, all readers together
  std::optional<motion::MotionReport> asked;  ///< of the platform, when it moves
};

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
  TrialOutcome run(PlannedTrial planned);
  /// The model identified from a trial, or nothing when none comes within `limit_s` [s].
  std::optional<stillhand_msgs::FeedthroughModel> await_model(std::int64_t trial, double limit_s);
  /// Gives the canceller a model and waits for its answer.  @return why it wasn't taken, or empty
  std::string use(const cancellation::AugmentedModel& model);
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
  bool await_start(const PlannedTrial& planned, MissCounts& before);
  void announce(const PlannedTrial* planned, stillhand_msgs::SessionState session);
  void assign(const PlannedTrial& planned);
  [[nodiscard]] Tick newest_tick();
  /// @throws RefusedByProcess or std::runtime_error when a process ended.
  void throw_trouble() const;
  [[nodiscard]] std::vector<std::string> absent(const Seen& seen) const;
  bool await_armed(const PlannedTrial& planned, TrialOutcome& outcome);
  void follow(const PlannedTrial& planned, TrialOutcome& outcome);
  [[nodiscard]] static std::string why_not_armed(const Seen& seen, std::string_view service);
  void see_force_out(bool completed);
  void look_for_death(TrialOutcome& outcome);
  void collect(TrialOutcome& outcome, const MissCounts& before);
  [[nodiscard]] static MissCounts count(const Seen& seen);

  runtime::Service& service_;
  Watch watch_;
  bool silent_ = false;  ///< the trouble is a process's silence: it may still be there
  Progress progress_;
  runtime::Publisher<stillhand_msgs::TrialControl> control_;
  runtime::Publisher<stillhand_msgs::TrialAssignment> assignment_;
  runtime::Publisher<stillhand_msgs::AugmentedModel> augmented_model_;
  std::int32_t models_ = 0;  ///< augmented ones given
  std::mutex mutex_;
  std::condition_variable news_;
  Seen seen_;
  std::string trouble_;    ///< a process that ended, an emergency stop, or empty
  bool mendable_ = false;  ///< it said that the user can mend it
};

}  // namespace stillhand::experiment
