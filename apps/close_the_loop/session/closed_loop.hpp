// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/close_the_loop/session/session.hpp"
#include "apps/close_the_loop/verdict/verdict.hpp"
#include "apps/libraries/session/protocol.hpp"

namespace stillhand::close_the_loop {

struct LoopOptions {
  session::ProtocolOptions protocol;  ///< conditions are A, B, C
  DeclaredDrive declared;
  cancellation::HandCompliance hand;  ///< the hand that the adaptation assumes
  int most_rounds = 3;
  diagnosis::DiagnoseOptions diagnose;  ///< of the body, a_y to f; with for_each
  /// Before each longer step; false ends the loop (diagnosis::Interrupted).
  std::function<bool(const std::string& step)> progress = [](const std::string&) { return true; };
  /// Runs work that takes long and has no deadline.
  std::function<void(const std::function<void()>&)> aside = [](const auto& work) { work(); };
};

/// One pass through diagnosis, augmentation and C+.
struct Round {
  Verdict verdict;
  TrialRun trial;                    ///< C+
  bool augmented = false;            ///< it ran with the verdict's model; else it is C'
  cancellation::ControlModel model;  ///< with which it ran
  bool better = false;               ///< its trial has a smaller RMS error than the best before it
  std::string outcome;               ///< one sentence
};

struct LoopResult {
  identification::FeedthroughModel paper_model;
  std::vector<TrialRun> trials;  ///< I, then A, B, C in the order in which they ran, then C'
  cancellation::ControlModel followed_model;  ///< of C': the paper's, gain and phase followed
  std::vector<Round> rounds;                  ///< at least one
  std::size_t final_round = 0;                ///< the round with the best C+
  cancellation::ControlModel control_model;   ///< of the best trial: where the next round begins

  [[nodiscard]] const TrialRun& trial(const std::string& label) const;
  /// C+ of the final round, whether or not it was better than C.
  [[nodiscard]] const TrialRun& plus() const { return rounds[final_round].trial; }
  [[nodiscard]] const Verdict& verdict() const { return rounds[final_round].verdict; }
};

/// Those of C, C' and C+.
std::vector<const TrialRun*> cancelling_trials(const LoopResult& result);

/// Identifies, runs A, B and C with the paper's model and C' with the same model followed,
/// diagnoses, augments and runs C+; repeats until nothing new is found or C+ no longer improves,
/// README "The loop".  The last good model stays.
/// @throws ConfigError when the identification yields no usable model or a recording cannot be
///         diagnosed, diagnosis::Interrupted
LoopResult close_loop(Session& session, const LoopOptions& options);

}  // namespace stillhand::close_the_loop
