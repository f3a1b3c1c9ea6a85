// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "apps/compare/core/comparison.hpp"

namespace stillhand::compare {

/// Files that write_report() writes.
inline constexpr const char* kReportFiles[] = {
    "comparison.html", "comparison.json", "comparison.svg", "comparison.png", "comparison.csv"};

/// Page and figure in a folder that exists; comparison.json is the caller's.
/// @throws as report::render()
void write_report(const Comparison& all, const std::filesystem::path& folder);

}  // namespace stillhand::compare
