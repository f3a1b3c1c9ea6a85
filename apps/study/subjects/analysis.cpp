// SPDX-License-Identifier: Apache-2.0
#include "apps/study/subjects/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <limits>
#include <span>

#include "services/core/contract/config_error.hpp"

namespace stillhand::study {
namespace {

using session::kMetrics;

constexpr Eigen::Index kThirds = 3;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Least gain of the own model, Eq. SU-4: a quotient of gains is meaningless without a gain.
constexpr double kLeastGain = 0.05;
constexpr std::size_t kWindow_s = 10;  // of the moving averages, which have one value a second

bool has(const Analysis& analysis, Condition condition) {
  return analysis.conditions.contains(condition);
}

template <typename Value>
std::vector<double> over_subjects(const std::vector<SubjectResult>& results, Value value) {
  std::vector<double> out;
  out.reserve(results.size());
  for (const SubjectResult& result : results) out.push_back(value(result));
  return out;
}

MultivariateResult manova(const Eigen::MatrixXd& observations,
                          const statistics::ManovaLayout& layout) {
  try {
    return {statistics::two_way_manova(observations, layout), ""};
  } catch (const ConfigError& error) {
    return {std::nullopt, error.what()};
  }
}

MultivariateResult main_effects(const Analysis& analysis, std::span<const Condition> conditions,
                                std::size_t subjects) {
  const std::size_t count = conditions.size();
  Eigen::MatrixXd observations(count * subjects, kMetricCount);
  for (std::size_t row = 0; row < count * subjects; ++row) {
    const auto& metrics = analysis.conditions.at(conditions[row % count]);
    for (std::size_t k = 0; k < kMetricCount; ++k) {
      observations(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k)) =
          metrics[k].per_subject[row / count];
    }
  }
  return manova(observations,
                {static_cast<Eigen::Index>(subjects), static_cast<Eigen::Index>(count), 1});
}

// RMS error and dwell ratio of one third of a trial, from consecutive windows.
std::array<double, 2> third(const TrackedTrial& trial, std::size_t which, std::size_t windows) {
  double square_mm2 = 0.0;
  double dwell = 0.0;
  for (std::size_t w = 0; w < windows; ++w) {
    const std::size_t at = (which * windows + w) * kWindow_s;
    square_mm2 += std::pow(trial.metrics.moving_rms_mm[at], 2);
    dwell += trial.metrics.moving_dwell[at];
  }
  const auto n = static_cast<double>(windows);
  return {std::sqrt(square_mm2 / n), dwell / n};
}

MultivariateResult thirds(const std::vector<SubjectResult>& results,
                          std::span<const Condition> conditions) {
  const auto entries = results.front().trials.begin()->second.metrics.moving_rms_mm.size();
  const std::size_t windows = (entries + kWindow_s - 1) / kWindow_s / kThirds;
  if (windows == 0) return {std::nullopt, "the thirds of a trial need 30 s or more"};
  const auto subjects = static_cast<Eigen::Index>(results.size());
  const auto count = static_cast<Eigen::Index>(conditions.size());
  Eigen::MatrixXd observations(subjects * count * kThirds, 2);
  for (Eigen::Index row = 0; row < observations.rows(); ++row) {
    const auto& result = results[static_cast<std::size_t>(row / (count * kThirds))];
    const auto& trial =
        result.trials.at(conditions[static_cast<std::size_t>(row / kThirds % count)]);
    const auto values = third(trial, static_cast<std::size_t>(row % kThirds), windows);
    observations.row(row) << values[0], values[1];
  }
  return manova(observations, {subjects, count, kThirds});
}

std::vector<PooledLine> pooled_lines(const std::vector<SubjectResult>& results,
                                     Condition condition) {
  std::vector<PooledLine> out(signal::kReferenceLines);
  for (std::size_t line = 0; line < out.size(); ++line) {
    std::complex<double> cursor = 0.0;
    std::complex<double> error = 0.0;
    std::vector<double> remnant;
    for (const SubjectResult& result : results) {
      const auto& at = result.trials.at(condition).metrics.lines[line];
      out[line].frequency_hz = at.frequency_hz;
      out[line].paper_db += 20.0 * std::log10(std::abs(at.gain));
      // Eq. SU-3.  X_r = X_p + X_e, so X_p/X_r = G/(1 + G) and X_e/X_r = 1/(1 + G).
      const auto& closed = result.trials.at(condition).closed_loop;
      cursor += closed.empty() ? at.gain / (1.0 + at.gain) : closed[line];
      error += closed.empty() ? 1.0 / (1.0 + at.gain) : 1.0 - closed[line];
      remnant.push_back(std::min(1.0, 1.0 / at.error_snr));
    }
    const auto n = static_cast<double>(results.size());
    out[line].paper_db /= n;
    out[line].reference_db = 20.0 * std::log10(std::abs(cursor / error));
    out[line].remnant_share = statistics::median(remnant);
  }
  return out;
}

void add_wrong_models(Analysis& analysis, const std::vector<SubjectResult>& results) {
  for (const auto& entry : results.front().wrong) {
    const char which = entry.first;
    WrongModel& wrong = analysis.wrong[which];
    for (std::size_t k = 0; k < kMetricCount; ++k) {
      wrong.metrics[k] = summarised(over_subjects(results, [&](const SubjectResult& result) {
        return kMetrics[k].of(result.wrong.at(which));
      }));
    }
    wrong.surviving_share = over_subjects(results, [&](const SubjectResult& result) {
      const double b = result.trials.at(kB).metrics.rms_error_mm;
      const double c = result.trials.at(kC).metrics.rms_error_mm;
      if (!(b - c > kLeastGain * b)) return kNan;
      return (b - result.wrong.at(which).metrics.rms_error_mm) / (b - c);
    });
  }
}

// Eq. SU-5, over the subjects whose metric was found in all three conditions.
Restoration restoration_by(const Analysis& analysis, Condition cancelled) {
  Restoration out;
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    out[k] = statistics::restored_share(analysis.conditions.at(kA)[k].per_subject,
                                        analysis.conditions.at(kB)[k].per_subject,
                                        analysis.conditions.at(cancelled)[k].per_subject);
  }
  return out;
}

}  // namespace

MetricSample summarised(std::vector<double> values) {
  MetricSample out;
  std::vector<double> known;
  std::copy_if(values.begin(), values.end(), std::back_inserter(known),
               [](double value) { return std::isfinite(value); });
  out.per_subject = std::move(values);
  if (known.empty()) {
    out.mean = std::numeric_limits<double>::quiet_NaN();
    return out;
  }
  out.known = known.size();
  out.mean = statistics::mean(known);
  if (known.size() > 1) out.standard_deviation = statistics::standard_deviation(known);
  out.box = statistics::box_plot(known);
  return out;
}

Comparison compared(const Analysis& analysis, Condition from, Condition to) {
  Comparison out{from, to, {}};
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    const auto& before = analysis.conditions.at(from)[k].per_subject;
    const auto& after = analysis.conditions.at(to)[k].per_subject;
    if (before.size() < 2) continue;
    try {
      out.tests[k] = statistics::paired_t_test(after, before);
    } catch (const ConfigError&) {
      // No variance, or a crossover that was not found: no test.
    }
  }
  return out;
}

namespace {

std::vector<Condition> conditions_in(const Analysis& analysis) {
  std::vector<Condition> out;
  for (const auto& entry : analysis.conditions) out.push_back(entry.first);
  return out;
}

void add_comparisons(Analysis& analysis) {
  const auto add = [&analysis](Condition from, Condition to) {
    if (!has(analysis, from) || !has(analysis, to)) return;
    analysis.comparisons.push_back(compared(analysis, from, to));
  };
  add(kA, kB);
  for (const Condition to : {kC, kCPrime, kCPlus, kD, kE, kF}) add(kB, to);
  for (const auto& [from, to] : kCancellerSteps) add(from, to);
  for (const Condition each : conditions_in(analysis)) {
    if (!is_mitigation(each)) continue;
    add(kB, each);
    add(kC, each);
  }
}

}  // namespace

bool gives(Condition condition, const session::Number& number) {
  return (number.in & session::kStudy) != 0 &&
         (number.still == session::Still::kGiven ||
          std::ranges::find(kCancelling, condition) != kCancelling.end());
}

std::string words_of_conditions(const Analysis& analysis) {
  std::string out;
  for (const Condition condition : conditions_in(analysis)) {
    out += (out.empty() ? "" : ", ") + std::string(name_of(condition));
  }
  return out;
}

Analysis analyse(const std::vector<SubjectResult>& results) {
  Analysis out;
  for (const auto& entry : results.front().trials) {
    const Condition condition = entry.first;
    for (std::size_t k = 0; k < session::kNumbers.size(); ++k) {
      out.conditions[condition][k] =
          summarised(over_subjects(results, [&](const SubjectResult& result) {
            return session::kNumbers[k].of(result.trials.at(condition));
          }));
    }
    out.open_loop[condition] = pooled_lines(results, condition);
  }
  for (const Condition condition : conditions_in(out)) {
    if (!cancels(condition) && !is_mitigation(condition)) continue;
    if (has(out, kA) && has(out, kB)) {
      out.restoration[condition] = restoration_by(out, condition);
    }
  }
  add_comparisons(out);
  if (has(out, kA) && has(out, kB) && has(out, kC)) {
    out.main_effects = main_effects(out, kPaperConditions, results.size());
    out.thirds = thirds(results, kPaperConditions);
  } else {
    out.main_effects.reason = out.thirds.reason = "needs conditions A, B and C";
  }
  const std::vector<Condition> all = conditions_in(out);
  if (all.size() > 1 && !std::ranges::equal(all, kPaperConditions)) {
    out.all_main_effects = main_effects(out, all, results.size());
    out.all_thirds = thirds(results, all);
  }
  if (has(out, kB) && has(out, kC)) add_wrong_models(out, results);
  for (const SubjectResult& result : results) {
    if (!result.identification.paper_unusable.empty()) ++out.refined_used;
  }
  return out;
}

}  // namespace stillhand::study
