// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/lab/lab_options.hpp"
#include "apps/libraries/session/core/trial_numbers.hpp"
#include "apps/libraries/session/results.hpp"
#include "apps/libraries/session/trial_outcome.hpp"

namespace stillhand::lab {

/// Nobody tracked: no person's pointer, and no stick whose angle a device measures.
bool simulated_subject(const LabOptions& options);
/// The trial of a condition, the newest if C ran again; nullptr: none was completed.
const session::TrialResult* trial_of(const session::SessionResult& result,
                                     session::Condition label);
/// (B - C) / (B - A) of a number; nothing without all three conditions.
/// @param label  of the condition in the place of C
std::optional<double> restoration_of(const session::SessionResult& result,
                                     const session::Number& number,
                                     session::Condition label = session::Condition::kC);
/// The same of the RMS error behind each trial's first third: the study's share (SU-19).
std::optional<double> settled_restoration_of(const session::SessionResult& result,
                                             session::Condition label);
/// The trials with a mitigation of their own, in the order of the study's table, and C+ before
/// them.
std::vector<const session::TrialResult*> mitigated_trials(const session::SessionResult& result);

/// "C"; where its condition ran twice, "C of trial 3".
std::string name_in(const session::SessionResult& result, const session::TrialResult& trial);
/// "C disturbed at 11.5 s: sensing was late by 73 ms, force 0 for 0.12 s": the longest five, one of
/// each trial among them, and how to see all.
std::vector<std::string> disturbance_lines(const session::SessionResult& result);
/// "C: the model no longer holds since 63 s of trial 3, by 30 % of the predicted force; ...".
std::vector<std::string> model_change_lines(const std::vector<session::TrialOutcome>& outcomes);
/// "trial 3, C, does not count: rig: interlock opened".
std::vector<std::string> uncounted_lines(const std::vector<session::TrialOutcome>& outcomes);

/// Contents of summary.json (README, "summary.json").
nlohmann::ordered_json summary_json(const LabOptions& options,
                                    const std::vector<session::TrialOutcome>& outcomes,
                                    const session::SessionResult& result, bool interrupted);

}  // namespace stillhand::lab
