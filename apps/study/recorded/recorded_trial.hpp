// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "apps/study/recorded/registration.hpp"
#include "apps/study/subjects/planned.hpp"
#include "apps/study/subjects/subject_session.hpp"

namespace stillhand::study {

/// One complete tracking trial of a participant.
struct RecordedTrial {
  std::string participant;  ///< code
  std::string session;      ///< number or name of the session
  std::int64_t number = 0;  ///< in its session
  std::int64_t place = 0;   ///< counted from 1 over all complete tracking trials of the participant
  Condition condition = kA;
  TrackedTrial tracked;
  double lost_share = 0.0;  ///< [-] of its samples
  std::int64_t block = 0;   ///< of an experiment, from 1; 0: not announced
  std::int64_t step = 0;    ///< place in the participant's plan, from 1; 0: not announced
};

/// One complete pegged trial of a participant.
struct PeggedTrial {
  std::string participant;
  std::string session;
  std::int64_t number = 0;  ///< in its session
};

/// Which trial: participant, session, number.
using TrialId = std::tuple<std::string, std::string, std::int64_t>;
inline TrialId id_of(const RecordedTrial& trial) {
  return {trial.participant, trial.session, trial.number};
}

/// The participants of an analysis: one entry of `participants` for each of `results`.
struct Selection {
  std::vector<std::string> participants;
  std::vector<SubjectResult> results;
  std::vector<std::string> left_out;  ///< who lacks a trial, and which
  std::vector<std::string> remarks;   ///< rare conditions, and who has fewer trials than is usual
  std::set<TrialId> used;             ///< the trials that the results are means of
};

/// The analysis that an experiment registered.  The record's results are those with its exclusion
/// rules.
struct Registered {
  Registration registration;
  std::vector<std::string> excluded;  ///< one line each: trial or participant, why, and the rule
  std::vector<PlannedComparison> planned;
  Selection without;  ///< without the rules
  Analysis analysis_without;
  std::vector<PlannedComparison> planned_without;
};

/// What recordings give besides the results of the participants.
struct RecordedSource {
  std::vector<std::string> participants;  ///< codes, one for each entry of StudyRecord::results
  std::vector<RecordedTrial> trials;      ///< all complete ones, also those not in the tables
  std::vector<std::string> left_out;      ///< one line each: trial or participant, and why
  std::vector<std::string> remarks;       ///< one line each, on who and what is in the tables
  std::set<TrialId> used;                 ///< of `trials` those in the tables
  std::vector<PeggedTrial> pegged;        ///< all complete ones
  std::set<std::string> simulated;        ///< codes of subjects who are no persons
  std::string digest;                     ///< of the pre-registration, or empty
  std::optional<Registered> registered;   ///< none: no experiment.yaml was given
};

}  // namespace stillhand::study
