// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/contract/trial.hpp"
#include "services/recording/core/mcap/mcap_reader.hpp"

namespace stillhand::measurement {

/// One trial as its recording tells it.
struct SessionTrial {
  Trial trial;
  char letter = '?';  ///< I: identification; A, B, C as the paper's conditions; ?: not told
  Tick end_tick = 0;  ///< first tick that no longer belongs to it; earlier than planned: broken off
  std::int64_t recorded_ticks = 0;  ///< [-] of them, samples of stillhand/sensed

  [[nodiscard]] bool holds(Tick tick) const noexcept {
    return tick >= trial.start_tick && tick < end_tick;
  }
  /// "2 (B, 20 s)"
  [[nodiscard]] std::string name() const;
};

struct SessionTrials {
  std::uint32_t rig = 0;             ///< the first that was met
  bool other_rigs = false;           ///< samples of others are in the file too
  std::vector<SessionTrial> trials;  ///< recorded ones, in order of their numbers
  std::string broken;                ///< why reading ended early, or empty
};

/// First pass over a session's recording: which trials it holds.  A recording that tells of none is
/// one trial as a whole.
/// @throws stillhand::ConfigError when it has no samples of stillhand/sensed.
SessionTrials find_trials(recording::McapReader& reader, const std::string& path);

/// @param wanted  as ReadOptions::trial
/// @throws stillhand::ConfigError naming the trials there are.
const SessionTrial& choose(const SessionTrials& trials, const std::string& wanted,
                           const std::string& path);

/// Which trial was taken, of which.
std::vector<std::string> notes_of(const SessionTrials& trials, const SessionTrial& chosen);

}  // namespace stillhand::measurement
