// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/libraries/experiment/core/design.hpp"

namespace stillhand::experiment {

/// What links the shown labels to the conditions.  It comes from the sealed file.
struct Assignment {
  std::uint64_t order_seed = 0;
};

/// A participant's labels of n conditions, at most 17, in the order of Design::conditions: X, Y, Z,
/// W, ... shuffled for each participant, so that who recognises a trial knows nothing of others'.
std::vector<std::string> labels_of(std::size_t conditions, const Assignment& assignment,
                                   std::size_t participant);

enum class StepKind : std::uint8_t { kPractice, kTrial, kQuestion, kBreak };

/// One step of a participant's protocol.  Its place in the plan is its number.
struct Step {
  StepKind kind = StepKind::kTrial;
  std::int64_t block = 0;     ///< from 1; 0: before the first block
  std::int64_t place = 0;     ///< of a trial, from 1 over all blocks
  std::size_t condition = 0;  ///< of a trial: index in Design::conditions
  std::size_t question = 0;   ///< index in Design::questions
  std::uint64_t motion_seed = 0;
  std::uint64_t target_seed = 0;
};

using Plan = std::vector<Step>;

/// The protocol of one participant:
///
///   practice, questions, { block: { trial, questions }, questions, break }, questions
///
/// The same design, assignment and participant give the same plan, so a journal needs no plan.
/// @param participant  from 0
Plan plan_of(const Design& design, const Assignment& assignment, std::size_t participant);

/// Block 0, and the seeds, of the trial at a place of a participant's plan.  @param place  from 1
Step trial_at_place(const Design& design, std::size_t participant, std::int64_t place);

/// Seeds of the nth practice trial (from 0) of a participant, in the fields of a step.
Step practice_trial(const Design& design, std::size_t participant, std::int64_t number);

/// Seed of a session's processes: remnant and sensor noise.  @param session  from 1
std::uint64_t session_seed(const Design& design, std::size_t participant, std::int64_t session);
/// Seed of the motion of the pegged trial of that session.
std::uint64_t identification_seed(const Design& design, std::size_t participant,
                                  std::int64_t session);

/// Number of trials in a plan.
std::int64_t trials_of(const Plan& plan);

}  // namespace stillhand::experiment
