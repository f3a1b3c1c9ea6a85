// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "services/core/display/prompt.hpp"

namespace stillhand::lab {

/// From the announcement of a trial to the first tick of its ramp [s]: time to compute motion and
/// target.
inline constexpr double kTrialLead_s = 1.0;

using PromptKind = display::PromptKind;

/// Lengths that the topic takes [bytes].
inline constexpr std::size_t kMostPromptText = 1000;
inline constexpr std::size_t kMostPromptWord = 40;
/// Largest answer [-].
inline constexpr std::int64_t kMostPromptSteps = 9;

/// What the tracking screen shows the participant in addition to the task.  It never holds the
/// condition: the participant reads it, and so does the experimenter.
struct Prompt {
  PromptKind kind = PromptKind::kNothing;
  std::string participant = {};           ///< code; empty: none
  std::int64_t block = 0, blocks = 0;     ///< from 1; 0: none
  std::int64_t trial = 0, trials = 0;     ///< place in the protocol, from 1; 0: none
  std::optional<double> wait_s = {};      ///< [s] until the wait ends; none: no fixed end
  std::string text = {};                  ///< UTF-8, lines end in a newline
  std::string lowest = {}, highest = {};  ///< words at both ends of the scale
  std::int64_t steps = 0;                 ///< answers are 1 to this number; 0: it takes none
};

/// One answer, as it came from the bus.
struct AnswerSeen {
  std::uint64_t prompt = 0;  ///< number of the prompt
  std::int64_t value = 0;
};

}  // namespace stillhand::lab
