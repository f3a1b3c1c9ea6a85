// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/libraries/report/page.hpp"
#include "apps/libraries/report/plot/figure.hpp"
#include "apps/vehicle/region.hpp"

namespace stillhand::vehicle {

inline constexpr const char* kRegionFigure = "stable_region";

/// The stable region over gain and delay, predicted and run, without and with cancellation.
report::Figure region_figure(const RegionOptions& options, const Region& region);
/// One row for each drive, and for each limit.
std::string runs_csv(const Region& region);
std::string limits_csv(const Region& region);
/// `summary.json`.
std::string region_json(const RegionOptions& options, const Region& region);
/// Agreement and stops, for a terminal.
std::string region_text(const RegionOptions& options, const Region& region);
report::Page region_page(const RegionOptions& options, const Region& region,
                         const std::string& command_line,
                         const std::vector<report::Drawing>& drawings);
/// Every file name that the verb may write.
std::vector<std::string> region_files();

}  // namespace stillhand::vehicle
