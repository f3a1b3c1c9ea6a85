// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/session/paper_table.hpp"
#include "apps/study/subject_session.hpp"
#include "services/statistics/descriptive.hpp"
#include "services/statistics/manova.hpp"
#include "services/statistics/t_test.hpp"

namespace stillhand::study {

inline constexpr std::size_t kMetricCount = session::kMetrics.size();
/// Millimetres in one unit of the paper's RMS error, which has none; README, "The paper's unit".
inline constexpr double kPaperUnit_mm = 5.5;

/// One metric under one condition.
struct MetricSample {
  std::vector<double> per_subject;
  double mean = 0.0;
  std::optional<double> standard_deviation;  ///< needs two subjects
  statistics::BoxPlot box;
  std::size_t known = 0;  ///< subjects that the three above are over: a crossover may not be found
};

/// Two conditions, all metrics.
struct Comparison {
  char from, to;
  /// Differences to - from; none for one subject or without variance.
  std::array<std::optional<statistics::TTest>, kMetricCount> tests;
};

/// Multivariate test, or why there is none.
struct MultivariateResult {
  std::optional<statistics::Manova> manova;
  std::string reason;
};

/// Open loop at one line, over the subjects of a condition.
struct PooledLine {
  double frequency_hz = 0.0;
  double paper_db = 0.0;       ///< mean over subjects of 20 log10 |X_p/X_e|
  double reference_db = 0.0;   ///< |mean X_p/X_r / mean X_e/X_r|, Eq. SU-3: no bias by the remnant
  double remnant_share = 0.0;  ///< of the error's power at the line [-], median
};

/// One wrong model, over the subjects.
struct WrongModel {
  std::array<MetricSample, kMetricCount> metrics;
  /// Share of the own model's gain that survives, Eq. SU-4, by RMS error, per subject [-]; NaN
  /// where the own model gains less than a twentieth of B's error.
  std::vector<double> surviving_share;
};

/// Every number that the report and the summary show.
struct Analysis {
  std::map<char, std::array<MetricSample, kMetricCount>> conditions;
  std::map<char, MetricSample> cancelled_share;  ///< conditions with a motor
  std::map<char, MetricSample> crossover_reference_hz;
  std::map<char, std::vector<PooledLine>> open_loop;
  std::vector<Comparison> comparisons;
  MultivariateResult main_effects;  ///< A, B, C with one trial a cell: no interaction
  MultivariateResult thirds;        ///< with the thirds of a trial as replicates: RMS error, dwell
  std::array<std::optional<double>, kMetricCount> restoration;  ///< Eq. SU-5
  std::map<char, WrongModel> wrong;
  std::int64_t refined_used = 0;  ///< subjects whose paper's fit could not cancel
};

/// Mean, deviation and box of the values that are finite: a crossover may not be found.  NaN mean
/// when none is.
MetricSample summarised(std::vector<double> values);

Analysis analyse(const std::vector<SubjectResult>& results);

}  // namespace stillhand::study
