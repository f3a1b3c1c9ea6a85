// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/core/contract/trial.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"

namespace stillhand::measurement {

/// One trial, as recorded.
struct SessionTrial {
  Trial trial;
  char letter = '?';  ///< I: identification; A, B, C: the paper's conditions; ?: unknown
  std::string named;  ///< a mitigation's name, or "free": no letter; else empty
  Tick end_tick = 0;  ///< first tick after the trial; earlier than planned if it was ended early
  std::int64_t recorded_ticks = 0;  ///< [-] samples of stillhand/sensed within the trial
  bool blinded = false;  ///< tracking in an experiment: nobody reads its condition by accident

  [[nodiscard]] bool holds(Tick tick) const noexcept {
    return tick >= trial.start_tick && tick < end_tick;
  }
  /// "2 (B, 20 s)"; "2 (20 s)" of one that is blinded
  [[nodiscard]] std::string name() const;
};

struct SessionTrials {
  std::uint32_t rig = 0;             ///< rig of the first sample
  bool other_rigs = false;           ///< the file also holds samples of other rigs
  std::vector<SessionTrial> trials;  ///< recorded ones, in order of their numbers
  std::string broken;                ///< why reading ended early, or empty
  std::string rig_parts;             ///< which were devices, in the rig's words; empty: none
};

/// First pass over a session's recording: finds its trials.  A recording that announces none is one
/// trial as a whole.
/// @throws stillhand::ConfigError when it has no samples of stillhand/sensed.
SessionTrials find_trials(recording::McapReader& reader, const std::string& path);

/// @param wanted  as ReadOptions::trial
/// @param last    of several that match take the last, instead of none; not of --trial, so a
///                blinded one answers to its condition, too
/// @throws stillhand::ConfigError naming the trials of the recording.
const SessionTrial& choose(const SessionTrials& trials, const std::string& wanted,
                           const std::string& path, bool last = false);

/// Notes on the chosen trial and on the others of the recording.
std::vector<std::string> notes_of(const SessionTrials& trials, const SessionTrial& chosen);

}  // namespace stillhand::measurement
