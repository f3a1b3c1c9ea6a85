// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "apps/session/protocol.hpp"
#include "services/mitigation/core/part.hpp"

namespace stillhand::session {

/// A mitigation that a session over the bus runs as a condition.
struct LiveMitigation {
  Condition condition;  ///< its letter is lower-case, and stays inside the program
  const char* name;     ///< as on the command line, and in `stillhand study --mitigations`
  std::vector<mitigation::Part> parts;
};

/// All, in the order of the study's table.  Their numbers are those that the study chose on other
/// people (apps/study/METHOD.md, SU-18, seed 20261125), and the hand is the average of CC-5: no
/// trial of a session changes them.  The arms of `scheduled` are the person's own:
/// ProtocolOptions::arms.
const std::vector<LiveMitigation>& live_mitigations();

/// The mitigation of a condition; nullptr: A to F and P are none.
const LiveMitigation* live_mitigation(Condition condition);

/// Whether a condition needs trial J: a part of it reads the feedthrough to position.
bool needs_position(Condition condition);

/// How results name the condition of a trial: its letter, or the mitigation's name.
/// @param label  PlannedTrial::label
std::string condition_label(char label);

/// The letter of a name in a recorded assignment; 0: this program does not know it.
char letter_of(std::string_view mitigation);

}  // namespace stillhand::session
