// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "contract/trial.hpp"
#include "equivalence/replay.hpp"
#include "idl/session.h"

namespace stillhand::equivalence {

/// The message of a trial, from TrialControl or TrialAssignment.  @throws NotRecorded
template <typename Message>
const Message& of_trial(const std::vector<Message>& messages, std::int64_t trial) {
  const auto found = std::find_if(messages.begin(), messages.end(),
                                  [trial](const Message& each) { return each.trial() == trial; });
  if (found == messages.end()) {
    throw NotRecorded("trial " + std::to_string(trial) + " is not in the recording");
  }
  return *found;
}

inline Trial trial_of(const stillhand_msgs::TrialControl& message) {
  Trial trial;
  trial.number = message.trial();
  trial.phase = message.phase() == stillhand_msgs::PHASE_PEGGED     ? TrialPhase::kPegged
                : message.phase() == stillhand_msgs::PHASE_TRACKING ? TrialPhase::kTracking
                                                                    : TrialPhase::kIdle;
  trial.start_tick = message.start_tick();
  trial.duration_ticks = message.duration_ticks();
  trial.ramp_ticks = message.ramp_ticks();
  return trial;
}

}  // namespace stillhand::equivalence
