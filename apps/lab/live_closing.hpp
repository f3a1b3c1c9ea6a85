// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "apps/lab/lab_options.hpp"
#include "apps/lab/live_trials.hpp"
#include "apps/lab/pause_verdict.hpp"
#include "apps/libraries/session/protocol.hpp"

namespace stillhand::lab {

/// What `--close live` may put behind the trial of C: the pegged trial again, and C again, with
/// numbers behind those of the plan.
std::vector<session::PlannedTrial> closing_trials(const session::ProtocolOptions& protocol);

/// Closes the loop while the session runs, METHOD "Closing during the session": where the model of
/// C did not hold to the end of its trial, the pause behind it identifies and diagnoses again, and
/// C runs again, with the new model or as C+.
class LiveClosing {
 public:
  /// @param options, trials  outlive this
  LiveClosing(const LabOptions& options, LiveTrials& trials) : options_(options), trials_(trials) {}

  /// After a completed trial.  @return false: the session ends
  bool after(const session::TrialOutcome& outcome);

 private:
  bool close();
  [[nodiscard]] bool takes(const PauseVerdict& verdict, std::int64_t number);
  /// Gives the canceller C+.  @return false: it goes on with C's model
  [[nodiscard]] bool give_plus(std::int64_t number);
  bool run_again(bool plus);

  const LabOptions& options_;
  LiveTrials& trials_;
};

}  // namespace stillhand::lab
