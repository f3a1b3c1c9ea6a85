// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/lab/lab.hpp"
#include "apps/libraries/session/trial_outcome.hpp"

namespace stillhand::lab {

/// Evaluates, prints the table next to the paper's, writes summary.json and model.json.
/// @return exit status of the lab.
int report_session(const LabOptions& options, std::vector<session::TrialOutcome> outcomes,
                   bool interrupted);

}  // namespace stillhand::lab
