// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/experiment/export/bids.hpp"
#include "apps/recordings/topic_table.hpp"

namespace stillhand::experiment {

/// Writes a data set as plain tables (README, "Tables"): participants, trials, answers, and the
/// samples of each trial.
/// @param file  a kind of file of apps/recordings; written and closed, not published
/// @returns trials left out, one line each
/// @throws as write_bids()
std::vector<std::string> write_tables(const DataSet& set, const Folder& folder,
                                      recordings::TableFile& file, const OnSession& on_participant);

}  // namespace stillhand::experiment
