// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/libraries/experiment/core/plan.hpp"

namespace stillhand::experiment {

/// Kinds of lines in a participant's journal, and kUnblinded in that of the folder.
enum class EntryKind : std::uint8_t {
  kSessionBegan,
  kTrialBegan,
  kTrialEnded,
  kQuestionAnswered,
  kBreakOver,
  kRepeatAsked,
  kNote,
  kSessionEnded,
  kExcluded,
  kUnblinded,
};

/// One line of a journal.  Fields that a kind does not use keep their defaults.
struct Entry {
  EntryKind kind = EntryKind::kNote;
  std::string time = {};                   ///< UTC, ISO 8601
  std::int64_t session = 0;                ///< from 1
  std::int64_t step = -1;                  ///< number in the plan; -1: identification, or none
  std::int64_t trial = -1;                 ///< number in the session's recording
  std::string label = {};                  ///< of a trial, blinded
  bool completed = false;                  ///< of a trial's or session's end
  std::optional<double> dwell_ratio = {};  ///< of a practice trial
  std::int64_t answer = 0;
  std::string digest = {};       ///< of experiment.yaml, at a session's begin
  std::string text = {};         ///< reason, note or name of a question
  std::string participant = {};  ///< of kUnblinded: whose conditions; empty: everybody's
  /// Of kUnblinded: participants whose protocol was complete then.  An older version did not write
  /// it.
  std::optional<std::int64_t> complete = {};

  bool operator==(const Entry&) const = default;
};

/// What a participant has done so far: the fold of the journal's entries over the plan.  Pure.
class Progress {
 public:
  Progress(const Design& design, const Plan& plan) : design_(design), plan_(plan) {}

  /// @throws ConfigError for an entry that does not fit the plan: a journal edited by hand
  void take(const Entry& entry);

  /// Number of the first step that is not done; nothing: the protocol is complete.
  [[nodiscard]] std::optional<std::size_t> next() const;
  [[nodiscard]] bool complete() const { return !next(); }

  [[nodiscard]] std::int64_t sessions() const noexcept { return sessions_; }
  [[nodiscard]] std::int64_t practice_trials() const noexcept {
    return static_cast<std::int64_t>(practice_.size());
  }
  /// The criterion of the practice was reached.
  [[nodiscard]] bool practised() const noexcept { return reached_; }
  [[nodiscard]] std::int64_t trials_done() const;
  [[nodiscard]] std::int64_t repeats() const noexcept { return repeats_; }
  /// Why the participant is excluded; empty: is not.
  [[nodiscard]] const std::string& excluded() const noexcept { return excluded_; }
  /// The last trial that was completed; what a repetition asks for.
  [[nodiscard]] std::optional<std::size_t> last_trial() const noexcept { return last_trial_; }
  /// A session began and has no end in the journal: it was killed, or it still runs.
  [[nodiscard]] bool session_open() const noexcept { return session_open_; }
  /// Digests of experiment.yaml at the beginnings of the sessions.
  [[nodiscard]] const std::set<std::string>& digests() const noexcept { return digests_; }

 private:
  const Step& step_of(const Entry& entry, StepKind kind) const;
  void take_trial(const Entry& entry);

  const Design& design_;
  const Plan& plan_;
  std::set<std::size_t> done_;
  std::vector<double> practice_;
  std::int64_t in_a_row_ = 0;
  bool reached_ = false;
  std::int64_t sessions_ = 0;
  bool session_open_ = false;
  std::int64_t repeats_ = 0;
  std::optional<std::size_t> last_trial_;
  std::string excluded_;
  std::set<std::string> digests_;
};

}  // namespace stillhand::experiment
