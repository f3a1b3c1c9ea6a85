// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "apps/study/report/output.hpp"
#include "apps/study/subjects/analysis.hpp"
#include "services/core/signal/reference.hpp"

/// Results of subjects that no loop has run: every number is chosen by the test.
namespace stillhand::study::made {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

inline TrackedTrial trial_of(double rms_error_mm, double dwell_ratio, double crossover_hz) {
  TrackedTrial trial;
  trial.metrics.rms_error_mm = rms_error_mm;
  trial.metrics.dwell_ratio = dwell_ratio;
  trial.metrics.crossover_hz = crossover_hz;
  trial.metrics.crossover_reference_hz = crossover_hz + 0.01;
  const auto design = signal::reference_design(180.0);
  for (std::size_t k = 0; k < trial.metrics.lines.size(); ++k) {
    const double frequency_hz = static_cast<double>(design.harmonics[k]) / 180.0;
    // An integrator that crosses 0 dB where the trial says.
    trial.metrics.lines[k] = {
        design.harmonics[k], frequency_hz, {0.0, -crossover_hz / frequency_hz}, 50.0, 25.0};
  }
  trial.target_m = {0.0, 0.01, 0.02};
  trial.cursor_m = {0.0, 0.005, -0.03};
  return trial;
}

/// A model of order 4 with other numbers for each seed, at a rate.
inline signal::DifferenceModel model_of(std::uint64_t seed, double rate_hz) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> any(-0.2, 0.2);
  signal::DifferenceModel model;
  model.rate_hz = rate_hz;
  model.denominator = {1.0};
  for (int i = 0; i < 4; ++i) model.denominator.push_back(any(engine));
  for (int i = 0; i < 5; ++i) model.numerator.push_back(3.2 + any(engine));
  return model;
}

inline Identification identification_of(std::uint64_t seed) {
  Identification found;
  found.paper.model = model_of(seed, 50.0);
  found.refined.model = model_of(seed + 100, 50.0);
  found.control.model = model_of(seed + 200, 1000.0);
  found.paper.heldout.free_run_vaf_percent = 90.0 + static_cast<double>(seed);
  found.refined.heldout.free_run_vaf_percent = kNan;
  for (int i = 0; i < 100; ++i) {
    found.estimate.frequency_hz.push_back(0.2 * i);
    found.estimate.response.push_back({-3.0 / (1.0 + i), 0.2 * i});
    found.estimate.magnitude_ci95.push_back(i % 2 == 0 ? 0.3 : 1.5);
    found.estimate.coherence.push_back(0.9);
  }
  return found;
}

/// Subjects with random metrics, and all that an analysis reads.
inline std::vector<SubjectResult> random_results(std::size_t subjects,
                                                 const std::vector<Condition>& order,
                                                 std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> error_mm(20.0, 60.0);
  std::uniform_real_distribution<double> share(0.1, 0.6);
  std::vector<SubjectResult> results(subjects);
  for (std::size_t i = 0; i < subjects; ++i) {
    results[i].order = order;
    results[i].identification = identification_of(seed + i);
    std::vector<Condition> sorted = order;
    std::ranges::sort(sorted);
    for (const Condition condition : sorted) {
      TrackedTrial trial = trial_of(error_mm(engine), share(engine), share(engine));
      trial.cancelled_share = condition == kC ? share(engine) : 0.0;
      trial.feedthrough_rms_n = error_mm(engine);
      for (int s = 0; s <= 50; ++s) {  // windows of 10 s that start 0 to 50 s into a minute
        trial.metrics.moving_rms_mm.push_back(error_mm(engine));
        trial.metrics.moving_dwell.push_back(share(engine));
      }
      results[i].trials[condition] = trial;
    }
  }
  return results;
}

/// @param order  "BCA"
inline std::vector<SubjectResult> random_results(std::size_t subjects, const std::string& order,
                                                 std::uint64_t seed) {
  std::vector<Condition> conditions;
  for (const char letter : order) conditions.push_back(named(std::string(1, letter)));
  return random_results(subjects, conditions, seed);
}

inline StudyRecord record_of(std::vector<SubjectResult> results) {
  StudyRecord record;
  record.options.subjects = static_cast<std::int64_t>(results.size());
  record.command_line = "stillhand study";
  record.results = std::move(results);
  record.analysis = analyse(record.results);
  return record;
}

}  // namespace stillhand::study::made
