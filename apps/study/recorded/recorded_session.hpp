// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/study/recorded/find_sessions.hpp"
#include "apps/study/recorded/recorded_trial.hpp"

namespace stillhand::study {

/// What one recording gives to a study.
struct RecordedSession {
  std::optional<Identification> identification;  ///< of the last complete pegged trial
  double identify_s = 0.0;                       ///< [s] its length
  std::vector<PeggedTrial> pegged;               ///< all complete ones
  std::vector<RecordedTrial> trials;    ///< complete tracking trials without practice; no place
  std::vector<RecordedTrial> practice;  ///< complete practice trials
  std::vector<std::string> left_out;    ///< one line each: trial, and why
  std::set<std::int64_t> other_model;   ///< complete trials that were not what their condition says
  bool plus_adds_nothing = false;       ///< a trial of C+ ran the identified model
  std::int64_t broken_trials = 0;       ///< tracking trials that were ended early
  bool simulated = false;               ///< the subject: nobody moved a pointer or a real stick
  std::string rig_parts;                ///< which were devices; empty: none
};

/// Least share of its samples that a complete trial has: of a session on its own, and where the
/// rules of an experiment decide how many may be lost.
inline constexpr double kLeastShare = 0.99;
inline constexpr double kLeastShareBeforeRules = 0.9;

/// A trial is complete if it was not ended early and has `least_share` of its samples.
/// @throws ConfigError for a recording that cannot be read
RecordedSession read_recorded_session(const SessionFile& file, double least_share = kLeastShare);

}  // namespace stillhand::study
