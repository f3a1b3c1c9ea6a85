// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/study/subjects/analysis.hpp"

/// Planned comparisons of this study, and the size of the next one.  Pure.
namespace stillhand::study {

/// One planned comparison.
struct PlannedComparison {
  Comparison comparison;
  /// p of Holm over all planned comparisons and metrics together, Eq. ST-13; none without a test.
  std::array<std::optional<double>, kMetricCount> p_holm;
};

/// Paired t-tests of the pairs whose conditions the analysis has, in their order.
std::vector<PlannedComparison> planned_comparisons(
    const Analysis& analysis, const std::vector<std::pair<Condition, Condition>>& pairs);

/// Participants that a paired t-test needs, Eq. SU-13.
struct Needed {
  std::string comparison;  ///< "A-B"
  std::size_t metric = 0;  ///< index of session::kMetrics
  std::string effect;      ///< "observed", "half of it", "given"
  double effect_dz = 0.0;  ///< [-]
  struct At {
    double wanted_power;       ///< [-]
    std::size_t participants;  ///< smallest number with that power
    double power;              ///< [-] at this number, Eq. ST-11
  };
  std::vector<At> at;  ///< empty: more than 80,000 participants, or not a number
};

/// Number of participants of the next study for each pair and metric: for the effect of these data
/// (Hedges' g_z), for half of it, and for the given ones; for power 0.8 and 0.9.
/// @param given_dz  [-] effect sizes, 0.01 to 100
/// @param alpha     [-] level of one test
std::vector<Needed> participants_needed(const Analysis& analysis,
                                        const std::vector<std::pair<Condition, Condition>>& pairs,
                                        const std::vector<double>& given_dz, double alpha);

}  // namespace stillhand::study
