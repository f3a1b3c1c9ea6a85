// SPDX-License-Identifier: Apache-2.0
#include "apps/study/report/figures.hpp"

#include <cmath>
#include <numbers>

#include "apps/libraries/session/protocol.hpp"
#include "apps/study/report/diagnoses_output.hpp"
#include "apps/study/report/report_sections.hpp"
#include "apps/study/subjects/analysis.hpp"

namespace stillhand::study {
namespace {

using report::Colour;

}  // namespace

std::vector<report::Figure> study_figures(const StudyRecord& record) {
  std::vector<report::Figure> figures{figure_estimate(record), figure_models(record)};
  if (!conditions_run(record, kFigureConditions).empty()) {
    figures.push_back(figure_traces(record));
    const auto& first = *record.results.front().trials.begin();
    if (first.second.metrics.moving_rms_mm.size() > 1) {  // a line needs two windows
      figures.push_back(figure_moving_rms(record));
      figures.push_back(figure_moving_dwell(record));
    }
  }
  for (const std::size_t metric : {std::size_t{0}, std::size_t{1}}) {
    figures.push_back(figure_box(record, metric));
  }
  if (!conditions_run(record, kFigureConditions).empty()) {
    figures.push_back(figure_open_loop(record));
  }
  figures.push_back(figure_box(record, 2));
  if (!record.analysis.wrong.empty()) figures.push_back(figure_wrong_models(record));
  if (record.simulated && !record.simulated->results.empty()) {
    figures.push_back(figure_simulated(record));
  }
  if (record.diagnoses && !record.diagnoses->people.empty()) {
    figures.push_back(figure_gain(*record.diagnoses));
  }
  return figures;
}

std::size_t typical_subject(const StudyRecord& record) {
  const auto& metrics = record.analysis.conditions.contains(kB)
                            ? record.analysis.conditions.at(kB)
                            : record.analysis.conditions.begin()->second;
  const std::vector<double>& values = metrics[0].per_subject;
  const double middle = metrics[0].box.median;
  std::size_t best = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::abs(values[i] - middle) < std::abs(values[best] - middle)) best = i;
  }
  return best;
}

double phase_up_to_deg(std::complex<double> response, double highest_deg) {
  const double deg = std::arg(response) * 180.0 / std::numbers::pi;
  return deg > highest_deg ? deg - 360.0 : deg;
}

// The palette begins with the conditions' own colours, in the order of their table.
report::Colour colour_of(Condition condition) {
  static_assert(static_cast<int>(Colour::kConditionF) == static_cast<int>(kF));
  return condition <= kF ? static_cast<Colour>(condition) : Colour::kNeutral;
}

std::string subject_name(const StudyRecord& record, std::size_t index) {
  return record.recorded ? record.recorded->participants[index]
                         : "subject " + std::to_string(index + 1);
}

std::vector<Condition> conditions_run(const StudyRecord& record, std::span<const Condition> among) {
  std::vector<Condition> out;
  for (const Condition condition : among) {
    if (record.analysis.conditions.contains(condition)) out.push_back(condition);
  }
  return out;
}

}  // namespace stillhand::study
