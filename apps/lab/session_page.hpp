// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/lab/lab_options.hpp"
#include "apps/libraries/report/page.hpp"
#include "apps/libraries/session/results.hpp"

namespace stillhand::lab {

inline constexpr const char* kSessionPage = "session.html";

/// The figures of each condition next to the paper's; and every mitigation, with C.
report::Table metrics_table(const session::SessionResult& result);
report::Table mitigations_table(const session::SessionResult& result);

/// One page for the person who tracked: the three figures of each condition next to the paper's,
/// and the traces.  It needs no other file.
/// @param drawings  of draw_session()
report::Page session_page(const LabOptions& options,
                          const std::vector<session::TrialOutcome>& outcomes,
                          const session::SessionResult& result,
                          const std::vector<report::Drawing>& drawings);

}  // namespace stillhand::lab
