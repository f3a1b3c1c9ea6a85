// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::lab {

/// What the diagnosis in the pause between two trials says.
struct PauseVerdict {
  std::string why_not = {};  ///< why there is no C+ to offer, as a clause; empty: there is one
  std::string found = {};  ///< what C+ leaves, and a linear model, where no fit has seen the force
  bool certain = false;    ///< there is an interval of the gain, and it excludes none
};

/// Reads `summary.json` of `stillhand close-the-loop --pegged`.  C+ is on offer where something
/// that counts is missing and the loop keeps C+, judged on the part that no fit has seen
/// (close_the_loop, CL-9 and CL-10).
/// @throws nlohmann::json::exception for another text
PauseVerdict pause_verdict(const std::string& summary);

}  // namespace stillhand::lab
