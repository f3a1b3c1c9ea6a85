// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/compare/core/comparison.hpp"
#include "apps/libraries/report/page.hpp"

namespace stillhand::compare {

/// Three digits.
std::string number(double value);

/// "study1, C+"
std::string name_of(const Comparison& all, std::size_t option);

/// What to use, for whom, and how sure that is: a sentence or two for each metric.
std::vector<std::string> findings(const Comparison& all);

/// A row for each option.
report::Table options_table(const Comparison& all);

/// comparison.json.
std::string comparison_json(const Comparison& all);

}  // namespace stillhand::compare
