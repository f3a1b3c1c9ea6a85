// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/core/contract/tick.hpp"

namespace stillhand::display {

/// What the experiment asks the screen to show.
enum class PromptKind : std::uint8_t {
  kNothing,
  kInstructions,
  kIdentification,
  kPractice,
  kTrial,
  kBreak,
  kQuestion,
  kEnd
};

/// Largest answer, and most boxes of a scale [-].
inline constexpr std::int64_t kMostSteps = 9;

/// One prompt of the experiment, as it came from the bus; it does not hold the condition.
struct Prompt {
  std::uint64_t number = 0;  ///< an answer names it; 0: none came yet
  PromptKind kind = PromptKind::kNothing;
  std::int64_t trial = 0, trials = 0;  ///< place in the protocol, from 1; 0: none
  Tick end_tick = -1;                  ///< the wait ends; -1: no fixed end
  std::vector<std::string> lines;      ///< UTF-8
  std::string lowest, highest;         ///< words at both ends of the scale
  std::int64_t steps = 0;  ///< answers are 1 to this number, at most kMostSteps; 0: none
};

}  // namespace stillhand::display
