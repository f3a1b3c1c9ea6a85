// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace stillhand::session {

/// What a participant has to know before the first trial: lines for the tracking screen, at most 8
/// of 100 bytes.  They say nothing of the conditions.
/// @param who  "mouse" or "gamepad": a person whose arm is simulated; anything else: a stick
std::vector<std::string> instructions(const std::string& who);

/// Of the trial with the stick free that identifies the feedthrough to position, a line each.
inline constexpr const char* kHoldStill =
    "Hold the stick still.\nKeep the cross in the box, which does not move.\n";

/// The same as one text, a line each.
std::string text_of(const std::vector<std::string>& lines);

}  // namespace stillhand::session
