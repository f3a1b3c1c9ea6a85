// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/libraries/session/core/trial_numbers.hpp"
#include "apps/study/subjects/conditions.hpp"
#include "apps/study/subjects/subject_session.hpp"
#include "services/core/statistics/descriptive.hpp"
#include "services/core/statistics/manova.hpp"
#include "services/core/statistics/ratio.hpp"
#include "services/core/statistics/t_test.hpp"

namespace stillhand::study {

inline constexpr std::size_t kMetricCount = session::kMetrics.size();
using session::kPaperUnit_mm;

/// One number under one condition.
struct MetricSample {
  std::vector<double> per_subject;
  double mean = 0.0;
  std::optional<double> standard_deviation;  ///< needs two subjects
  statistics::BoxPlot box;
  std::size_t known = 0;  ///< subjects in mean, deviation and box: a crossover may not be found
};

/// Two conditions, all metrics.
struct Comparison {
  Condition from, to;
  /// Tests of the differences to - from; none for one subject or without variance.
  std::array<std::optional<statistics::TTest>, kMetricCount> tests;
};

/// Multivariate test, or the reason why there is none.
struct MultivariateResult {
  std::optional<statistics::Manova> manova;
  std::string reason;
};

/// Open loop at one line, over the subjects of a condition.
struct PooledLine {
  double frequency_hz = 0.0;
  double paper_db = 0.0;  ///< mean over subjects of 20 log10 |X_p/X_e|
  double reference_db =
      0.0;  ///< |mean X_p/X_r / mean X_e/X_r|, Eq. SU-3: not biased by the remnant
  double remnant_share = 0.0;  ///< median share of the error's power at the line [-]
};

/// One wrong model, over the subjects.
struct WrongModel {
  std::array<MetricSample, kMetricCount> metrics;
  /// Surviving share of the own model's gain in RMS error, Eq. SU-4, per subject [-]; NaN if the
  /// own model gains less than a twentieth of B's error.
  std::vector<double> surviving_share;
};

/// Eq. SU-5, of each metric.
using Restoration = std::array<statistics::RestoredShare, kMetricCount>;
/// Of session::kNumbers; the metrics come first.
using Samples = std::array<MetricSample, session::kNumbers.size()>;

/// All numbers of the report and the summary.
struct Analysis {
  std::map<Condition, Samples> conditions;
  std::map<Condition, std::vector<PooledLine>> open_loop;
  std::vector<Comparison> comparisons;
  MultivariateResult main_effects;  ///< A, B, C with one value a cell: no interaction
  MultivariateResult thirds;        ///< RMS error and dwell, thirds of a trial as replicates
  /// The same two over all conditions, where these are two or more and not A, B and C alone.
  std::optional<MultivariateResult> all_main_effects;
  std::optional<MultivariateResult> all_thirds;
  /// Eq. SU-5 of C, C' and C+, as far as they were run next to A and B.
  std::map<Condition, Restoration> restoration;
  std::map<char, WrongModel> wrong;
  std::int64_t refined_used = 0;  ///< subjects whose paper's fit could not cancel
};

/// Whether a study's summary gives a number under a condition: some are of the motor alone.
bool gives(Condition condition, const session::Number& number);

/// Mean, deviation and box of the finite values: a crossover may not be found.  The mean is NaN if
/// no value is finite.
MetricSample summarised(std::vector<double> values);

/// Paired t-tests of the differences to - from.
/// @param from, to  conditions that the analysis has
Comparison compared(const Analysis& analysis, Condition from, Condition to);

/// "A, B, C, C', C+": the conditions of an analysis, in their order in its tests.
std::string words_of_conditions(const Analysis& analysis);

/// Eqs. SU-3 to SU-5; statistics of services/core/statistics.  Pure.
/// @param results  at least one subject, all with the same conditions
Analysis analyse(const std::vector<SubjectResult>& results);

}  // namespace stillhand::study
