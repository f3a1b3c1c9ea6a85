// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "idl/session.h"
#include "tests/equivalence/replay.hpp"

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

}  // namespace stillhand::equivalence
