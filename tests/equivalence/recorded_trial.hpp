// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "idl/session.h"
#include "tests/equivalence/replay.hpp"

namespace stillhand::equivalence {

/// The last message of a trial, from TrialControl or TrialAssignment: one that began later than it
/// was announced first was announced again.  @throws NotRecorded
template <typename Message>
const Message& of_trial(const std::vector<Message>& messages, std::int64_t trial) {
  const auto found = std::find_if(messages.rbegin(), messages.rend(),
                                  [trial](const Message& each) { return each.trial() == trial; });
  if (found == messages.rend()) {
    throw NotRecorded("trial " + std::to_string(trial) + " is not in the recording");
  }
  return *found;
}

}  // namespace stillhand::equivalence
