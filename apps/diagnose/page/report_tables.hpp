// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/diagnose/page/evidence.hpp"
#include "apps/libraries/report/page.hpp"

namespace stillhand::diagnose {

/// Held-out error of the baseline, after each effect, at the end; and the noise floor.
report::Table error_table(const diagnosis::Diagnosis& found);
/// What was found: kind, channel, form, improvement, ties.
report::Table effect_table(const diagnosis::Diagnosis& found);
/// Numbers of the effects, then of the linear part, with units and standard errors.
report::Table parameter_table(const Evidence& evidence);
/// The ten best candidates of each step of the search; the last table is the step that added none.
std::vector<report::Table> tried_tables(const Evidence& evidence);
/// The fifteen questions with the largest shares, before and after.
report::Table detection_table(const diagnosis::Diagnosis& found);
/// Sizes from which a further effect is found as often as not, the kinds in a row for each size.
report::Table limit_table(const diagnosis::Diagnosis& found);

/// Names of the kinds that were proposed in no step, separated by commas; empty: none.
std::string never_proposed(const diagnosis::Diagnosis& found);

}  // namespace stillhand::diagnose
