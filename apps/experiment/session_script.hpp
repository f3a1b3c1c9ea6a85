// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "apps/experiment/folder/folder.hpp"
#include "apps/lab/lab_options.hpp"
#include "apps/lab/live_trials.hpp"
#include "services/core/cancellation/control_model.hpp"

namespace stillhand::experiment {

/// One session of a participant, step by step, while its processes run.  Every step that is done is
/// in the journal before the next one begins.
class SessionScript {
 public:
  /// @param journal   open; outlives this
  /// @param progress  of the journal's entries; outlives this
  /// @param lab       of the session; its protocol has the lengths of the trials
  SessionScript(const Folder& folder, std::size_t index, Journal& journal, Progress& progress,
                const lab::LabOptions& lab);

  /// Runs until the protocol is complete, a trial breaks, or somebody ends the session.
  void run(lab::LiveTrials& trials);
  /// Why the session ended before the protocol was complete; empty: it is complete.
  [[nodiscard]] const std::string& ended() const noexcept { return ended_; }

  /// Trials that the session may run, for the rehearsal.
  [[nodiscard]] std::vector<session::PlannedTrial> possible_trials() const;

 private:
  void add(Entry entry);
  /// Takes notes, repetitions and an abort into the journal.  @return false: the session ends
  bool look(lab::LiveTrials& trials);
  bool identify(lab::LiveTrials& trials);
  bool identify(lab::LiveTrials& trials, const session::PlannedTrial& planned,
                const std::string& what);
  bool do_step(lab::LiveTrials& trials, std::size_t number);
  bool practise(lab::LiveTrials& trials, std::size_t number);
  bool track(lab::LiveTrials& trials, std::size_t number);
  bool take_break(lab::LiveTrials& trials, std::size_t number);
  bool ask(lab::LiveTrials& trials, std::size_t number);
  /// Shows what a person has to know, until the person goes on.  @return false: the session ends
  bool instruct(lab::LiveTrials& trials);
  void show_end(lab::LiveTrials& trials);
  /// What the screen shows before and during a step.
  [[nodiscard]] lab::Prompt prompt_of(lab::PromptKind kind, const Step& step) const;
  [[nodiscard]] bool with_person() const { return folder_.design().who != "simulated"; }
  /// Runs a trial until it is completed, again after each stop, unless an earlier one is asked for
  /// again before it begins.  @return false: the session ends
  bool run_trial(lab::LiveTrials& trials, std::size_t step, session::PlannedTrial planned);
  void give_model(lab::LiveTrials& trials, const std::string& condition);
  /// C+ of this session, where the design asks for it.  @return false: the session ends
  bool diagnose(lab::LiveTrials& trials);
  [[nodiscard]] session::PlannedTrial planned_of(const Step& step) const;
  [[nodiscard]] session::PlannedTrial practice_of(std::int64_t number) const;
  [[nodiscard]] session::PlannedTrial identification() const;
  [[nodiscard]] session::PlannedTrial free_identification() const;
  [[nodiscard]] const std::string& condition_of(const Step& step) const {
    return folder_.design().conditions[step.condition];
  }

  const Folder& folder_;
  std::size_t index_;
  Journal& journal_;
  Progress& progress_;
  const lab::LabOptions& lab_;
  Plan plan_;
  std::int64_t session_;
  std::int64_t numbers_ = 0;  ///< of trials in this session's recording
  bool first_ = true;         ///< no tracking trial ran in this session
  std::optional<cancellation::ControlModel> augmented_;
  double settled_s_ = 0.0;  ///< [s] until any of this session's models acts alone
  std::string ended_;
};

}  // namespace stillhand::experiment
