// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/close_the_loop/recorded/recorded_loop.hpp"
#include "apps/libraries/report/page.hpp"
#include "apps/libraries/report/plot/figure.hpp"

namespace stillhand::close_the_loop {

/// summary.json of the loop over recordings, README "From recordings".
std::string recorded_summary_json(const RecordedLoop& loop, const RecordedOptions& options);

/// The tables in the terminal.
void print_recorded(const RecordedLoop& loop);

/// Force and what each model leaves of it, a panel a record.
std::vector<report::Figure> recorded_figures(const RecordedLoop& loop);

/// report.html.  @param drawings  of recorded_figures()
report::Page recorded_page(const RecordedLoop& loop, const RecordedOptions& options,
                           const std::string& command_line,
                           const std::vector<report::Drawing>& drawings);

}  // namespace stillhand::close_the_loop
