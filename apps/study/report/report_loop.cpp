// SPDX-License-Identifier: Apache-2.0
// Report: the open loop, its crossover, the other mitigations and the wrong models.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "apps/libraries/report/text/text.hpp"
#include "apps/study/report/figures.hpp"
#include "apps/study/report/report_cells.hpp"
#include "apps/study/report/report_sections.hpp"
#include "services/core/statistics/descriptive.hpp"

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
  std::map<Condition, std::vector<PooledLine>> shown;
  for (const auto& [condition, lines] : analysis.open_loop) {
    if (condition > kC && !cancels(condition)) continue;  // the others are in open_loop.csv
    shown[condition] = lines;
    const std::string letter = name_of(condition);
    table.header.insert(table.header.end(),
                        {letter + " paper", letter + " ref.", letter + " rem."});
  }
  if (shown.empty()) return;
  for (std::size_t line = 0; line < signal::kReferenceLines; ++line) {
    std::vector<Cell> row{number(shown.begin()->second[line].frequency_hz, 3)};
    for (const auto& [condition, lines] : shown) {
      row.emplace_back(number(lines[line].paper_db, 1));
      row.emplace_back(number(lines[line].reference_db, 1));
      row.emplace_back(percent(lines[line].remnant_share, 0));
    }
    table.rows.push_back(row);
  }
  page.table(table);
}

report::Table numbers_table(const Analysis& analysis) {
  report::Table table;
  table.caption =
      "Every number, mean ± SD over the subjects; restored: (B − C)/(B − A) of the means, 100 % is "
      "the value on the stationary platform. The crossover f_c is by the paper's line through "
      "eleven "
      "points; that by the reference is of the cursor over the target, without the power of the "
      "remnant, "
      "which is what the hand does beyond following the target (identification, Eq. ID-15).";
  table.header = {"number"};
  for (const auto& entry : analysis.conditions) table.header.push_back(title_of(entry.first));
  table.header.insert(table.header.end(), {"restored by C [95 %]", "paper: A, B, C, restored"});
  for (std::size_t k = 0; k < session::kNumbers.size(); ++k) {
    const session::Number& shown = session::kNumbers[k];
    if ((shown.in & session::kStudy) == 0) continue;
    std::vector<Cell> row{shown.title};
    for (const auto& [condition, samples] : analysis.conditions) {
      row.emplace_back(gives(condition, shown) ? mean_and_deviation(samples[k], k) : "–");
    }
    if (k < kMetricCount) {
      row.emplace_back(restored_text(analysis, k));
      row.emplace_back(
          fmt::format("{}, {}, {}, {:.0f} %", number(paper_value(k, kA), decimals(k)),
                      number(paper_value(k, kB), decimals(k)),
                      number(paper_value(k, kC), decimals(k)), shown.paper->restored_percent),
          report::Emphasis::kFaint);
    }
    table.rows.push_back(row);
  }
  return table;
}

report::Table restorations_table(const Analysis& analysis) {
  report::Table table;
  table.caption =
      "Restoration (B − X)/(B − A) of the means, with its 95 % interval over the participants.";
  table.header = {"metric"};
  for (const auto& entry : analysis.restoration) {
    table.header.push_back(name_of(entry.first));
  }
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    std::vector<Cell> row{session::kMetrics[k].title};
    for (const auto& entry : analysis.restoration) {
      row.emplace_back(restored_text(analysis, k, entry.first));
    }
    table.rows.push_back(row);
  }
  return table;
}

namespace {

report::Table mitigations_table(const Analysis& analysis) {
  report::Table table;
  table.caption = "RMS error: restoration (B − X)/(B − A), and the paired t-test against B.";
  table.header = {"condition", "restored", "p"};
  for (const auto& [condition, metrics] : analysis.conditions) {
    const Comparison* test = find_comparison(analysis, kB, condition);
    std::string restored = "–";
    if (condition > kB && analysis.conditions.contains(kA) && analysis.conditions.contains(kB)) {
      const double a = analysis.conditions.at(kA)[0].mean;
      const double b = analysis.conditions.at(kB)[0].mean;
      restored = percent((b - metrics[0].mean) / (b - a), 0);
    }
    table.rows.push_back(
        {title_of(condition), restored,
         test != nullptr && test->tests[0] ? p_value(test->tests[0]->p) : std::string("–")});
  }
  return table;
}

// From one canceller to the next.
report::Table steps_table(const Analysis& analysis) {
  report::Table table;
  table.caption =
      "Differences between cancellers: paired t-tests over the participants; p is not adjusted.";
  table.header = {"step", "metric", "change [95 % CI]", "p", "g_z"};
  for (const auto& [from, to] : kCancellerSteps) {
    const Comparison* found = find_comparison(analysis, from, to);
    if (found == nullptr) continue;
    for (std::size_t k = 0; k < kMetricCount; ++k) {
      const auto& test = found->tests[k];
      std::vector<Cell> row{pair_word(from, to), session::kMetrics[k].title};
      if (test) {
        row.emplace_back(fmt::format("{} [{}, {}]", number(test->mean_difference, decimals(k)),
                                     number(test->ci_low, decimals(k)),
                                     number(test->ci_high, decimals(k))));
        row.emplace_back(p_value(test->p));
        row.emplace_back(test->hedges_gz ? number(*test->hedges_gz, 2) : "–");
      }
      table.rows.push_back(row);
    }
  }
  table.align.assign(table.header.size(), report::Align::kRight);
  table.align[0] = table.align[1] = report::Align::kLeft;
  return table;
}

}  // namespace

void add_mitigations(report::Page& page, const StudyRecord& record) {
  const Analysis& analysis = record.analysis;
  if (conditions_run(record, std::array{kD, kE, kF}).empty() || !analysis.conditions.contains(kB))
    return;
  page.section("Other mitigations");
  page.paragraph(fmt::format(
      "The paper names these as future work; all run with the motor off. D subtracts the "
      "predicted displacement from the command instead of pushing the hand, and uses an average "
      "person's arm. E adds {} N s/m to the stick. F rests the forearm on a pad of {} N/m and {} "
      "N s/m (assumed values) that moves with the platform.",
      short_number(record.options.damped_stick_n_s_m),
      number(record.options.arm_rest_stiffness_n_m, 0),
      number(record.options.arm_rest_damping_n_s_m, 0)));
  page.table(mitigations_table(analysis));
}

// "damping: platform moves, ..." of each mitigation.
std::vector<std::string> meanings(const Analysis& analysis) {
  std::vector<std::string> lines;
  for (const auto& [condition, metrics] : analysis.conditions) {
    if (!is_mitigation(condition)) continue;
    lines.push_back(
        fmt::format("{}: {}", session::name_of(condition), session::row_of(condition).meaning));
  }
  return lines;
}

void add_cancellers(report::Page& page, const Analysis& analysis) {
  const bool mitigates = std::ranges::any_of(
      analysis.conditions, [](const auto& entry) { return is_mitigation(entry.first); });
  const bool cancels_beyond =
      analysis.conditions.contains(kCPrime) || analysis.conditions.contains(kCPlus);
  if (!mitigates && !cancels_beyond) return;
  page.section(mitigates ? "Mitigations" : "Cancellers that go beyond the paper's");
  std::string text = "C cancels with the model of the session's pegged trial, as the paper does.";
  if (cancels_beyond) {
    text +=
        " C' uses the same model and adapts its gain and phase to the hand. C+ uses another model, "
        "of a file or of each session's diagnosis; where that found nothing, C's own.";
  }
  if (mitigates) {
    text +=
        " The others are mitigations of stillhand lab --conditions. The figures of traces, moving "
        "errors and open loops leave them out.";
  }
  page.paragraph(text);
  if (mitigates) page.list(meanings(analysis));
  page.table(mitigations_table(analysis));
  if (!analysis.restoration.empty()) page.table(restorations_table(analysis));
  if (cancels_beyond) page.table(steps_table(analysis));
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
                          percent(any ? statistics::median(shares) : NAN, 0),
                          percent(any ? *std::min_element(shares.begin(), shares.end()) : NAN, 0),
                          fmt::format("{} of {}", shares.size(), wrong.surviving_share.size())});
  }
  page.table(table);
  page.paragraph(
      "A share above 100 % is possible. Every subject's own model is that of the idle arm, and the "
      "tracking arm is stiffer. A wrong model that is stronger by chance can fit the tracking arm "
      "better than the own model.");
}

}  // namespace stillhand::study
