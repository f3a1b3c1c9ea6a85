// SPDX-License-Identifier: Apache-2.0
// Report: the open loop, its crossover, the other mitigations and the wrong models.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "apps/report/text.hpp"
#include "apps/study/figures.hpp"
#include "apps/study/report_cells.hpp"
#include "apps/study/report_sections.hpp"
#include "services/statistics/descriptive.hpp"

namespace stillhand::study {

using report::Cell;
using report::number;
using report::short_number;

void add_open_loop(report::Page& page, const Analysis& analysis) {
  report::Table table;
  table.caption =
      "Open loop at the target's fifteen frequencies, all subjects, in dB. Columns: the paper's "
      "estimate (mean of 20 log|X_p/X_e|); the estimate through the reference (|mean X_p/X_r| / "
      "|mean X_e/X_r|), which the remnant does not bias; and the median share of the remnant in "
      "the "
      "error's power at the line. In B and C this share includes the effect of the platform's "
      "motion.";
  table.header = {"f [Hz]"};
  std::map<char, std::vector<PooledLine>> shown;
  for (const auto& [condition, lines] : analysis.open_loop) {
    if (condition > 'C') continue;  // the others are in open_loop.csv
    shown[condition] = lines;
    const std::string letter(1, condition);
    table.header.insert(table.header.end(),
                        {letter + " paper", letter + " ref.", letter + " rem."});
  }
  if (shown.empty()) return;
  for (std::size_t line = 0; line < signal::kReferenceLines; ++line) {
    std::vector<Cell> row{number(shown.begin()->second[line].frequency_hz, 3)};
    for (const auto& [condition, lines] : shown) {
      row.emplace_back(number(lines[line].paper_db, 1));
      row.emplace_back(number(lines[line].reference_db, 1));
      row.emplace_back(percent(lines[line].remnant_share));
    }
    table.rows.push_back(row);
  }
  page.table(table);
}

void add_crossover(report::Page& page, const Analysis& analysis) {
  report::Table table;
  table.caption =
      "Crossover by the paper's line through eleven points; and through the reference, with the "
      "remnant's power subtracted (identification, Eq. ID-15).";
  table.header = {"condition", "paper's line [Hz]", "through the reference [Hz]"};
  for (const auto& [condition, metrics] : analysis.conditions) {
    table.rows.push_back({label_of(condition), mean_and_deviation(metrics[2], 2),
                          mean_and_deviation(analysis.crossover_reference_hz.at(condition), 2)});
  }
  page.table(table);
}

void add_mitigations(report::Page& page, const StudyRecord& record) {
  const Analysis& analysis = record.analysis;
  if (conditions_run(record, "DEF").empty() || !analysis.conditions.contains('B')) return;
  page.section("Other mitigations");
  page.paragraph(fmt::format(
      "The paper names these as future work; all run with the motor off. D subtracts the "
      "predicted displacement from the command instead of pushing the hand, and uses an average "
      "person's arm. E adds {} N s/m to the stick. F rests the forearm on a pad of {} N/m and {} "
      "N s/m (assumed values) that moves with the platform.",
      short_number(record.options.damped_stick_n_s_m),
      number(record.options.arm_rest_stiffness_n_m, 0),
      number(record.options.arm_rest_damping_n_s_m, 0)));
  report::Table table;
  table.caption = "Comparison with B, mean ± SD; the restoration is (B − X)/(B − A).";
  table.header = {"condition", "RMS error [mm]", "dwell ratio",
                  "f_c [Hz]",  "RMS restored",   "p (RMS, to B)"};
  for (const auto& [condition, metrics] : analysis.conditions) {
    const Comparison* test = find_comparison(analysis, 'B', condition);
    std::string restored = "–";
    if (condition > 'B' && analysis.conditions.contains('A')) {
      const double a = analysis.conditions.at('A')[0].mean;
      const double b = analysis.conditions.at('B')[0].mean;
      restored = percent((b - metrics[0].mean) / (b - a));
    }
    table.rows.push_back(
        {label_of(condition), mean_and_deviation(metrics[0], 0), mean_and_deviation(metrics[1], 1),
         mean_and_deviation(metrics[2], 2), restored,
         test != nullptr && test->tests[0] ? p_value(test->tests[0]->p) : std::string("–")});
  }
  page.table(table);
}

void add_wrong_models(report::Page& page, const Analysis& analysis) {
  if (analysis.wrong.empty()) return;
  page.section("A model that is not the subject's");
  report::Table table;
  table.caption =
      "Condition C with the wrong model, at the same motion and target. The surviving share is the "
      "part of the own model's gain in RMS error that remains. It covers the subjects whose own "
      "model gains.";
  table.header = {"model", "RMS error [mm]", "surviving, median", "worst subject", "subjects"};
  for (const auto& [which, wrong] : analysis.wrong) {
    std::vector<double> shares;
    std::copy_if(wrong.surviving_share.begin(), wrong.surviving_share.end(),
                 std::back_inserter(shares), [](double share) { return std::isfinite(share); });
    const bool any = !shares.empty();
    table.rows.push_back({which == 'O' ? "another subject's" : "mean of all others",
                          mean_and_deviation(wrong.metrics[0], 0),
                          percent(any ? statistics::median(shares) : NAN),
                          percent(any ? *std::min_element(shares.begin(), shares.end()) : NAN),
                          fmt::format("{} of {}", shares.size(), wrong.surviving_share.size())});
  }
  page.table(table);
  page.paragraph(
      "A share above 100 % is possible. Every subject's own model is that of the idle arm, and the "
      "tracking arm is stiffer. A wrong model that is stronger by chance can fit the tracking arm "
      "better than the own model.");
}

}  // namespace stillhand::study
