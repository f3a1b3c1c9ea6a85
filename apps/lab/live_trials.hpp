// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "apps/lab/core/prompt.hpp"
#include "apps/lab/core/requests.hpp"
#include "apps/libraries/session/trial_outcome.hpp"
#include "services/core/cancellation/control_model.hpp"
#include "services/core/identification/identifier.hpp"

namespace stillhand::lab {

/// A session over DDS while its processes run: trial by trial.
class LiveTrials {
 public:
  virtual ~LiveTrials() = default;
  /// Runs one trial; a pegged one lasts until its model is there.  A trial that a request stopped
  /// is run again after a request for a start, under the next number: the outcome's.  A trial that
  /// is not completed ends the session: run nothing after it.
  virtual const session::TrialOutcome& run(const session::PlannedTrial& planned) = 0;
  /// The same, without the second part: one that a request stopped is not run again.
  virtual const session::TrialOutcome& run_once(const session::PlannedTrial& planned) = 0;
  /// The same as run(), of a trial that the session's plan does not have: it gets the next number,
  /// and those of the plan move on.
  virtual const session::TrialOutcome& run_between(const session::PlannedTrial& planned) = 0;
  /// What the tracking screen shows the participant from now on.
  virtual void show(const Prompt& prompt) = 0;
  /// Shows a prompt with steps and waits for its answer, at most `wait_s` of the prompt.
  /// @param what  for the person at the terminal
  /// @return nothing: its time is over, or a request for a start went on without an answer, or the
  ///         session is interrupted.  @throws std::runtime_error when a process is lost
  virtual std::optional<std::int64_t> ask(const Prompt& prompt, const std::string& what) = 0;
  /// Waits between trials, until its time or the session is over.
  /// @param over  ends it too, looked at every 50 ms or sooner; empty: a request for a start does
  virtual void rest(const std::string& what, double seconds, const std::function<bool()>& over) = 0;
  /// One line for the person at the terminal, at once.  It is not on the bus, where a dashboard
  /// would show it to everybody.
  virtual void say(const std::string& line) = 0;
  /// One line for the recording, as an event.
  virtual void note(const std::string& text) = 0;
  /// What persons asked of the protocol since the last call.
  virtual Asked asked() = 0;
  /// The model identified last.
  [[nodiscard]] virtual const identification::FeedthroughModel& model() const = 0;
  /// Gives the canceller a model and waits until it acts alone (settled_after_s()): a trial must
  /// not begin with the one before.  @return why it was refused, or empty
  /// @throws std::runtime_error when the canceller does not answer: which model it has is not known
  virtual std::string use(const cancellation::ControlModel& model) = 0;
  [[nodiscard]] virtual bool interrupted() const = 0;
};

/// What happens in a session, between the processes' start and their end.
using Script = std::function<void(LiveTrials& trials)>;

}  // namespace stillhand::lab
