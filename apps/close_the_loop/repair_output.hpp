// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "apps/close_the_loop/repair/repair.hpp"
#include "apps/libraries/report/page.hpp"

namespace stillhand::close_the_loop {

/// `repair` of summary.json, README "Mend, cancel or leave".
nlohmann::ordered_json repair_json(const RepairList& list);
report::Table repair_table(const RepairList& list);
/// What each way takes off the tracking error.
report::Figure repair_figure(const RepairList& list);
/// How far the prediction of C' is from the trial.
std::string repair_check(const RepairList& list);

}  // namespace stillhand::close_the_loop
