// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "services/core/next_run/contest.hpp"
#include "services/files/next_run/plan_file.hpp"

namespace stillhand::diagnose {

/// What a planned run said about the causes that were tied.
struct BrokenTie {
  std::vector<next_run::Candidate> candidates;
  next_run::Evidence before;
  next_run::Evidence after;
};

/// @param before  the recording(s) that left the tie
/// @param run     the run of the plan
/// @throws stillhand::ConfigError where a channel is missing or the rate is another one
BrokenTie broken_tie(const next_run::PlanFile& plan, const diagnosis::Measurement& before,
                     const diagnosis::Measurement& run);

/// For people: which candidate is left, and the evidence against each other one.
std::string tie_table(const BrokenTie& tie);
/// The JSON of a verdict with the entry `tie`.
std::string with_tie(const std::string& json, const BrokenTie& tie);

}  // namespace stillhand::diagnose
