// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/lab/clocks.hpp"
#include "apps/lab/conductor.hpp"
#include "apps/lab/lab_options.hpp"
#include "apps/lab/live_trials.hpp"
#include "apps/lab/processes.hpp"
#include "apps/lab/rehearsal.hpp"
#include "apps/lab/stop_key.hpp"
#include "apps/libraries/report/progress.hpp"
#include "services/bus/service.hpp"

namespace stillhand::lab {

/// The trials of a session while every process runs.  One thread.
class ConductedTrials final : public LiveTrials {
 public:
  /// @param asked     what each trial asks of the platform
  /// @param outcomes  gets every trial that ran
  ConductedTrials(const LabOptions& options, const AskedMotions& asked, runtime::Service& service,
                  Processes& processes, std::vector<session::TrialOutcome>& outcomes);

  /// Waits for every process, begins the session and runs the script.
  /// @throws RefusedByProcess, std::runtime_error; what the script throws
  void run(const Script& script);
  /// Announces the end of the session.
  void end() { conductor_.end_session(); }
  /// Path of the recording on the recorder's own host; empty: the recorder did not report it.
  [[nodiscard]] std::string recording() { return conductor_.recording(); }

  const session::TrialOutcome& run(const session::PlannedTrial& planned) override;
  const session::TrialOutcome& run_once(const session::PlannedTrial& planned) override;
  const session::TrialOutcome& run_between(const session::PlannedTrial& planned) override;
  void show(const Prompt& prompt) override { conductor_.show(prompt); }
  std::optional<std::int64_t> ask(const Prompt& prompt, const std::string& what) override {
    return conductor_.ask(prompt, what);
  }
  void rest(const std::string& what, double seconds, const std::function<bool()>& over) override {
    conductor_.rest(what, seconds, over);
  }
  void say(const std::string& line) override;
  void note(const std::string& text) override { conductor_.note(text); }
  Asked asked() override { return conductor_.asked(); }
  [[nodiscard]] const identification::FeedthroughModel& model() const override { return model_; }
  std::string use(const cancellation::ControlModel& model) override;
  [[nodiscard]] bool interrupted() const override { return conductor_.interrupted(); }

 private:
  /// @param number  to which those that came between the plan's trials are added
  const session::TrialOutcome& run_as(const session::PlannedTrial& planned, std::int64_t number);
  /// The newest outcome, once its model is there.
  const session::TrialOutcome& finished();
  void take_model(session::TrialOutcome& outcome);

  const LabOptions& options_;
  const AskedMotions& asked_;
  std::vector<session::TrialOutcome>& outcomes_;
  identification::FeedthroughModel model_;
  bool identified_ = false;   ///< there is such a model
  std::int64_t between_ = 0;  ///< trials that a request stopped, or that the plan does not have
  report::ProgressLine progress_;
  Clocks clocks_;
  Conductor conductor_;
  std::optional<StopKey> stop_key_;
};

}  // namespace stillhand::lab
