// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/libraries/report/page.hpp"
#include "apps/libraries/session/on_time.hpp"

namespace stillhand::diagnose {

/// What the motor leaves of the feedthrough in a recorded trial of condition C, by cause.
struct RecordedSplit {
  std::string recording;
  std::int64_t number;  ///< of the trial
  std::string trial;    ///< as "3 (C, 20 s)"
  session::SplitTrial split;
};

/// The trials of condition C in the recordings of sessions, unless they are blinded.
/// @param trial   as ReadOptions::trial; empty: all
/// @param config  folder of the settings that the sessions ran with
/// @throws ConfigError when a session or a setting cannot be read
std::vector<RecordedSplit> recorded_splits(const std::vector<std::string>& recordings,
                                           const std::string& trial,
                                           const std::filesystem::path& config);

/// A few lines for the terminal, ahead of the verdict; empty without a split.
std::string splits_table(const std::vector<RecordedSplit>& splits);
/// out.json with `lateness`.
std::string with_splits(const std::string& json, const std::vector<RecordedSplit>& splits);
/// A section of the page; none without a split.
void add_splits(const std::vector<RecordedSplit>& splits, report::Page& page);

}  // namespace stillhand::diagnose
