// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "closed_loop/closed_loop.hpp"
#include "closed_loop/session.hpp"
#include "experiment/lab.hpp"

namespace stillhand::closed_loop {

/// The same over DDS: trials of the lab's processes, measured by what the session's recorder has
/// written.
class LiveTrialSession final : public Session {
 public:
  /// @param recording  the session's file, being written
  LiveTrialSession(experiment::LiveTrials& trials, std::filesystem::path recording)
      : trials_(trials), recording_(std::move(recording)) {}

  /// @throws std::runtime_error when the trial isn't completed, or the recording doesn't hold it
  TrialRun run(const experiment::PlannedTrial& planned, const std::string& label) override;
  identification::FeedthroughModel identify(const TrialRun& pegged) override;
  std::string use(const cancellation::AugmentedModel& model) override;

 private:
  experiment::LiveTrials& trials_;
  std::filesystem::path recording_;
};

/// Shares of cancelled force and how late it was cancelled, which the rig's truth in the recording
/// tells when the session has ended.
void judge_cancellation(const std::filesystem::path& recording,
                        const std::vector<experiment::TrialOutcome>& outcomes, LoopResult& result);

}  // namespace stillhand::closed_loop
