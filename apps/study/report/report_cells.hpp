// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "apps/libraries/report/text/text.hpp"
#include "apps/study/subjects/analysis.hpp"

/// Values and texts that several tables of the report share.
namespace stillhand::study {

using report::p_value;
using report::percent;

/// Digits after the point of a number, an index of session::kNumbers.
int decimals(std::size_t metric);

/// Whether any of its metrics was tested: one subject, or no variance, has no test.
bool has_test(const Comparison& comparison);
/// The paper's mean of a metric under condition A, B or C; RMS error at kPaperUnit_mm a unit.
double paper_value(std::size_t metric, Condition condition);

/// "23.1 ± 4.0", with the number of subjects if the metric was not found in all.
std::string mean_and_deviation(const MetricSample& sample, std::size_t metric);

/// "89 % [84, 93]": the restoration of a metric by C, C' or C+ with its interval, as far as known.
std::string restored_text(const Analysis& analysis, std::size_t metric, Condition condition = kC);

/// The comparison of two conditions, or nullptr.
const Comparison* find_comparison(const Analysis& analysis, Condition from, Condition to);

}  // namespace stillhand::study
