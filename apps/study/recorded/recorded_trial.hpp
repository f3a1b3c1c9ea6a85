// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/planned.hpp"
#include "apps/study/recorded/registration.hpp"
#include "apps/study/subject_session.hpp"

namespace stillhand::study {

/// One complete tracking trial of a participant.
struct RecordedTrial {
  std::string participant;  ///< code
  std::string session;      ///< number or name of the session
  std::int64_t number = 0;  ///< in its session
  std::int64_t place = 0;   ///< counted from 1 over all complete tracking trials of the participant
  char condition = '?';     ///< A, B or C
  TrackedTrial tracked;
  double lost_share = 0.0;  ///< [-] of its samples
};

/// The participants of an analysis: one entry of `participants` for each of `results`.
struct Selection {
  std::vector<std::string> participants;
  std::vector<SubjectResult> results;
  std::vector<std::string> left_out;  ///< who lacks a trial, and which
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
  std::string digest;                     ///< of the pre-registration, or empty
  std::optional<Registered> registered;   ///< none: no experiment.yaml was given
};

}  // namespace stillhand::study
