// SPDX-License-Identifier: Apache-2.0
// Report: Tables I and II of the paper, restoration, calibration, and the statistics.
#include <fmt/format.h>

#include <cmath>

#include "apps/libraries/report/text/text.hpp"
#include "apps/study/report/report_cells.hpp"
#include "apps/study/report/report_sections.hpp"
#include "services/core/statistics/power.hpp"

namespace stillhand::study {
namespace {

using report::Cell;
using report::Emphasis;
using report::number;
using report::short_number;
using session::kMetrics;

// Tables I and II of the paper: two conditions, their difference, its significance.
report::Table paper_table(const Analysis& analysis, Condition from, Condition to, const char* title,
                          double session::Paper::* paper_p) {
  report::Table table;
  table.caption = title;
  table.header = {"metric", name_of(from), name_of(to)};
  const Comparison* comparison = find_comparison(analysis, from, to);
  // One subject, for example: there is nothing to test.
  const bool tested = has_test(*comparison);
  if (tested) table.header.insert(table.header.end(), {"change [95 % CI]", "p", "g_z"});
  table.header.push_back(fmt::format("paper {}, {}", name_of(from), name_of(to)));
  table.header.push_back("paper p");
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    std::vector<Cell> row{kMetrics[k].title, mean_and_deviation(analysis.conditions.at(from)[k], k),
                          mean_and_deviation(analysis.conditions.at(to)[k], k)};
    const auto& test = comparison->tests[k];
    if (test) {
      row.emplace_back(fmt::format("{} [{}, {}]", number(test->mean_difference, decimals(k)),
                                   number(test->ci_low, decimals(k)),
                                   number(test->ci_high, decimals(k))));
      row.emplace_back(p_value(test->p), test->p < 0.01 ? Emphasis::kStrong : Emphasis::kNone);
      row.emplace_back(test->hedges_gz ? number(*test->hedges_gz, 2) : "–");
    } else if (tested) {
      row.insert(row.end(), 3, Cell("–"));
    }
    row.emplace_back(
        number(paper_value(k, from), decimals(k)) + ", " + number(paper_value(k, to), decimals(k)),
        Emphasis::kFaint);
    row.emplace_back(short_number(kMetrics[k].paper->*paper_p), Emphasis::kFaint);
    table.rows.push_back(row);
  }
  return table;
}

report::Table calibration_table(const Analysis& analysis, bool is_default) {
  report::Table table;
  table.caption =
      is_default
          ? "Comparison of the population with the paper. A and B are calibrated, the RMS error "
            "with a unit that was itself inferred from the dwell ratios. C is a prediction."
          : "Comparison of this study with the paper. A and B were calibrated with another "
            "population or other lengths of the trials.";
  table.header = {"metric", "condition", "study", "paper", "study / paper", "role"};
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    for (const Condition condition : kPaperConditions) {
      const double mean = analysis.conditions.at(condition)[k].mean;
      const double paper = paper_value(k, condition);
      const double ratio = mean / paper;
      const bool calibrated = is_default && condition != kC;
      table.rows.push_back(
          {kMetrics[k].title, std::string(name_of(condition)), number(mean, decimals(k)),
           number(paper, decimals(k)),
           Cell(number(ratio, 2),
                calibrated && std::abs(ratio - 1.0) > 0.1 ? Emphasis::kBad : Emphasis::kNone),
           calibrated   ? "calibrated"
           : is_default ? "predicted"
                        : "–"});
    }
  }
  const double ours = analysis.conditions.at(kB)[0].mean / analysis.conditions.at(kA)[0].mean;
  const double theirs = kMetrics[0].paper->b / kMetrics[0].paper->a;
  table.rows.push_back({"RMS error, B / A (no unit needed)", "", number(ours, 2), number(theirs, 2),
                        number(ours / theirs, 2), is_default ? "calibrated" : "–"});
  return table;
}

void add_outcome(report::Page& page, const Analysis& analysis) {
  const double restored = analysis.restoration.at(kC)[0].share.value_or(NAN);
  const double paper = kMetrics[0].paper->restored_percent / 100.0;
  page.paragraph(fmt::format(
      "The motor cancels {} of the feedthrough force and restores {} of the RMS error. {}",
      percent(analysis.conditions.at(kC)[session::index_of("cancelled_share")].mean, 0),
      restored_text(analysis, 0),
      restored > paper
          ? "That is more than in the paper. Between the pegged trial and tracking, these "
            "subjects differ only in the stiffness of a co-contracted arm. Real subjects "
            "also change posture and grip over minutes and adapt to the motor. The motion "
            "also disturbs them in other ways than through the hand."
          : "That is less than in the paper. This population's tracking arms differ more "
            "from the idle ones that were identified, or its feedthrough differs more "
            "from the model."));
}

void add_effect(report::Table& table, const char* name, const statistics::MultivariateTest& test) {
  table.rows.push_back(
      {name, short_number(test.wilks_lambda), number(test.wilks.f, 2),
       number(test.wilks.numerator_df, 0) + ", " + number(test.wilks.denominator_df, 1),
       Cell(p_value(test.wilks.p), test.wilks.p < 0.01 ? Emphasis::kStrong : Emphasis::kNone)});
}

void add_manova(report::Page& page, const MultivariateResult& result, const std::string& caption) {
  if (!result.manova) {
    page.paragraph(fmt::format("{} No test: {}.", caption, result.reason));
    return;
  }
  report::Table table;
  table.caption = caption;
  table.header = {"effect", "Wilks' Λ", "F (Rao)", "degrees of freedom", "p"};
  add_effect(table, "condition", result.manova->condition);
  add_effect(table, "subject", result.manova->subject);
  if (result.manova->interaction) add_effect(table, "interaction", *result.manova->interaction);
  page.table(table);
}

}  // namespace

void add_paper_tables(report::Page& page, const StudyRecord& record) {
  const Analysis& analysis = record.analysis;
  page.table(
      paper_table(analysis, kA, kB,
                  "Table I: the effect of the motion. Mean ± SD over the subjects; g_z is Hedges' "
                  "corrected effect size of the differences; p is not adjusted for three metrics.",
                  &session::Paper::p_ab));
  page.table(paper_table(analysis, kB, kC,
                         "Table II: the effect of cancellation. Columns as in Table I.",
                         &session::Paper::p_bc));
  if (record.recorded) return;  // what follows explains simulated subjects
  add_outcome(page, analysis);
  page.table(calibration_table(analysis, is_calibrated(record.options)));
}

void add_statistics(report::Page& page, const Analysis& analysis) {
  page.section("Multivariate analysis of variance");
  add_manova(page, analysis.main_effects,
             "The paper's conditions A, B and C. All three metrics, with one value a cell. Only "
             "the main effects are tested, because an "
             "interaction cannot be separated from the error.");
  add_manova(
      page, analysis.thirds,
      "The paper's conditions A, B and C. RMS error and dwell ratio, with the thirds of each trial "
      "(whole windows of 10 s) as "
      "replicates, which makes the interaction of condition and subject testable. The thirds "
      "of one trial are not independent, so these p-values are too small. The crossover "
      "needs a whole trial.");
  if (analysis.all_main_effects && analysis.all_thirds) {
    const std::string all = "The conditions " + words_of_conditions(analysis);
    add_manova(page, *analysis.all_main_effects, all + ". All three metrics, main effects.");
    add_manova(page, *analysis.all_thirds,
               all + ". RMS error and dwell ratio, thirds of each trial.");
  }
  const Comparison* test = find_comparison(analysis, kB, kC);
  if (test == nullptr) return;
  report::Table table;
  table.caption =
      "Number of subjects needed to find the change from B to C at α = 0.01, if its size is that "
      "of this study.";
  table.header = {"metric", "effect size d_z", "for power 0.8", "for power 0.95"};
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    if (!test->tests[k]) continue;
    const double dz = test->tests[k]->cohen_dz;
    if (std::abs(dz) > 100.0 || std::abs(dz) < 0.01) continue;
    table.rows.push_back({kMetrics[k].title, number(dz, 2),
                          std::to_string(statistics::subjects_for_power(dz, 0.8, 0.01)),
                          std::to_string(statistics::subjects_for_power(dz, 0.95, 0.01))});
  }
  if (!table.rows.empty()) page.table(table);
}

}  // namespace stillhand::study
