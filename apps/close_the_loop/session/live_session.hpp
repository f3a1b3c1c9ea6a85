// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "apps/close_the_loop/session/closed_loop.hpp"
#include "apps/close_the_loop/session/session.hpp"
#include "apps/lab/lab.hpp"

namespace stillhand::close_the_loop {

/// Trials of the lab's processes over DDS, measured by what the session's recorder has written.
class LiveTrialSession final : public Session {
 public:
  /// @param recording  the session's file, being written
  LiveTrialSession(lab::LiveTrials& trials, std::filesystem::path recording)
      : trials_(trials), recording_(std::move(recording)) {}

  /// @throws std::runtime_error when the trial is not completed, or the recording does not hold it
  TrialRun run(const session::PlannedTrial& planned, const std::string& label) override;
  identification::FeedthroughModel identify(const TrialRun& pegged) override;
  std::string use(const cancellation::ControlModel& model) override;

 private:
  lab::LiveTrials& trials_;
  std::filesystem::path recording_;
  std::int64_t last_number_ = -1;
};

/// Adds to each trial the share of force that was cancelled, the delay of the counterforce, the
/// forces and the causes of what is left.  They come from the rig's truth in the recording, after
/// the session has ended.
/// @param answers  none: no causes
void judge_cancellation(const std::filesystem::path& recording,
                        const std::vector<session::TrialOutcome>& outcomes,
                        const std::optional<session::AnswerConfigs>& answers, LoopResult& result);

}  // namespace stillhand::close_the_loop
