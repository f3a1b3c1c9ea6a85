// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "apps/study/explain/explanation_output.hpp"
#include "apps/study/report/report_cells.hpp"
#include "services/core/statistics/descriptive.hpp"

namespace stillhand::study {
namespace {

using report::Cell;
using report::number;
using report::short_number;

constexpr std::size_t kPairsListed = 12;

std::string interval(const Marginal& marginal) {
  return fmt::format("{} {} [{}, {}]", marginal.name, short_number(marginal.median),
                     short_number(marginal.low), short_number(marginal.high));
}

std::string joined(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

report::Table ranking_table(const Explanation& explanation,
                            const std::vector<Hypothesis>& hypotheses, std::size_t most,
                            const char* caption) {
  report::Table table;
  table.caption = caption;
  table.header = {"cause",          "log evidence over none", "parameters: median [95 %]",
                  "z of B-C means", "z of B-C SDs",           "p of the tables"};
  table.align = {report::Align::kLeft,  report::Align::kRight, report::Align::kLeft,
                 report::Align::kRight, report::Align::kRight, report::Align::kRight};
  const double nothing = explanation.single.front().log_evidence;
  std::vector<const Hypothesis*> ranked;
  ranked.reserve(hypotheses.size());
  for (const Hypothesis& one : hypotheses) ranked.push_back(&one);
  std::ranges::stable_sort(ranked, std::ranges::greater{},
                           [](const Hypothesis* one) { return one->log_evidence; });
  for (std::size_t i = 0; i < std::min(most, ranked.size()); ++i) {
    const Hypothesis& one = *ranked[i];
    std::vector<std::string> parameters;
    for (const Marginal& marginal : one.parameters) parameters.push_back(interval(marginal));
    table.rows.push_back(
        {one.name,
         fmt::format("{:.1f} ± {:.1f}", one.log_evidence - nothing, one.log_evidence_error),
         joined(parameters), fmt::format("{:.1f}, {:.1f}, {:.1f}", one.z[6], one.z[7], one.z[8]),
         fmt::format("{:.1f}, {:.1f}, {:.1f}", one.z[12], one.z[13], one.z[14]),
         short_number(one.fit_p)});
  }
  return table;
}

report::Table judged_table(const Explanation& explanation) {
  report::Table table;
  table.caption =
      "Distance from the paper in its standard errors, on subjects that the inference did not see. "
      "A-B and B-C stand for the changes B - A and C - B. "
      "Nothing is calibrated again for none and paper_chain.";
  table.header = {"cause",   "A: RMS, dwell, f_c", "A-B means",          "A-B SDs", "B-C means",
                  "B-C SDs", "restored",           "log score over none"};
  const auto three = [](const TableVector& z, Eigen::Index first) {
    return fmt::format("{:.1f}, {:.1f}, {:.1f}", z[first], z[first + 1], z[first + 2]);
  };
  for (const Judged& one : explanation.judged) {
    table.rows.push_back({one.name, three(one.z, 0), three(one.z, 3), three(one.z, 9),
                          three(one.z, 6), three(one.z, 12),
                          fmt::format("{:.0f}, {:.0f}, {:.0f} %", 100.0 * one.restored[0],
                                      100.0 * one.restored[1], 100.0 * one.restored[2]),
                          number(one.log_score - explanation.judged[0].log_score, 1)});
  }
  return table;
}

report::Table measurable_table(const Explanation& explanation) {
  report::Table table;
  table.caption =
      "What an experiment would have to estimate to decide: mean ± deviation over subjects, with "
      "each cause. The force is that of the body on a held stick.";
  table.header = {"cause"};
  for (const Observable& observable : observables()) table.header.push_back(observable.name);
  for (const Judged& one : explanation.judged) {
    std::vector<Cell> row{one.name};
    for (const Observable& observable : observables()) {
      std::vector<double> values;
      for (const Response& subject : one.subjects) {
        values.push_back(observable.scale * subject.observed.*observable.value);
      }
      row.emplace_back(fmt::format("{} ± {}", number(statistics::mean(values), 1),
                                   number(statistics::standard_deviation(values), 1)));
    }
    table.rows.push_back(row);
  }
  return table;
}

void add_verdict(report::Page& page, const Explanation& explanation) {
  const Hypothesis& best = explanation.best();
  page.section("What explains it");
  std::vector<std::string> parameters;
  for (const Marginal& marginal : best.parameters) parameters.push_back(interval(marginal));
  page.paragraph(fmt::format(
      "Of {} causes alone and {} pairs, {} explains the tables best: its log evidence is {:.1f} "
      "above that of no cause. {}",
      causes().size(), explanation.pairs.size(), best.name,
      best.log_evidence - explanation.single.front().log_evidence,
      parameters.empty() ? "" : "Posterior median and 95 % interval: " + joined(parameters) + "."));
  for (const bool all : {false, true}) {
    const auto names = indistinguishable(all ? explanation.all() : explanation.single);
    if (names.empty()) continue;
    page.paragraph(fmt::format(
        "The tables cannot tell these {} apart (the least probable is less than 20 times less "
        "probable than the best): {}.",
        all ? "single causes and pairs" : "single causes", joined(names)));
  }
  const auto percents = [](const Judged& one) {
    return fmt::format("{:.0f}, {:.0f} and {:.0f} %", 100.0 * one.restored[0],
                       100.0 * one.restored[1], 100.0 * one.restored[2]);
  };
  page.paragraph(
      fmt::format("If the paper's chain is the cause, a canceller on time restores {} of RMS "
                  "error, dwell ratio "
                  "and f_c. The paper restores 47, 32 and 27 %.",
                  percents(explanation.judged[0])));
  if (explanation.compensated) {
    page.paragraph(fmt::format("With the subjects of the best explanation it restores {}.",
                               percents(*explanation.compensated)));
  }
}

void add_means(report::Page& page, const Explanation& explanation) {
  add_verdict(page, explanation);
  page.section("Before and after");
  page.table(judged_table(explanation));
  page.section("Ranking");
  page.table(ranking_table(explanation, explanation.single, explanation.single.size(),
                           "One cause. z: distance from the paper in its standard errors, after "
                           "calibration."));
  page.table(
      ranking_table(explanation, explanation.pairs, kPairsListed, "Two causes: the best pairs."));
  page.section("What would decide");
  page.table(measurable_table(explanation));
  page.section("The candidates");
  page.table(causes_table(causes()));
}

report::Page explanation_page(const Explanation& explanation, const std::string& command_line) {
  report::Page page("What explains the paper's C",
                    "The model predicts that cancellation restores more than the paper's twelve "
                    "people got. This page looks for causes in the paper's Tables I and II; "
                    "apps/study/METHOD.md has the equations, SU-7 to SU-10 and SU-23 to SU-25.");
  page.banner(report::kSimulatedBanner);
  page.facts({{"seed", std::to_string(explanation.options.seed)},
              {"subjects for each setting", std::to_string(explanation.options.subjects)},
              {"unit of the RMS error", number(explanation.options.unit_mm, 1) + " mm"},
              {"computed in", number(explanation.wall_s, 0) + " s"},
              {"made by", report::made_by()},
              {"command line", command_line}});
  if (explanation.spread) add_spread(page, *explanation.spread);
  if (!explanation.single.empty()) add_means(page, explanation);
  return page;
}

}  // namespace

report::Table causes_table(const std::vector<Cause>& causes) {
  report::Table table;
  table.caption = "The candidates, with the source of each range.";
  table.header = {"cause", "what it says", "range of its parameter", "source"};
  table.align = std::vector(4, report::Align::kLeft);
  for (const Cause& cause : causes) {
    table.rows.push_back({cause.name, cause.what,
                          cause.grid.empty() ? std::string("none")
                                             : fmt::format("{} {} to {}", cause.parameter,
                                                           short_number(cause.grid.front()),
                                                           short_number(cause.grid.back())),
                          cause.source});
  }
  return table;
}

const std::vector<Observable>& observables() {
  static const std::vector<Observable> kAll{
      {"delay of the counterforce [ms]", &Observed::counterforce_delay_s, 1000.0},
      {"force cancelled [%]", &Observed::cancelled_share, 100.0},
      {"feedthrough force, C over B [%]", &Observed::feedthrough_ratio, 100.0},
      {"VAF of the pegged model, unseen [%]", &Observed::pegged_vaf_percent, 1.0}};
  return kAll;
}

void write_explanation(const Explanation& explanation, const std::string& command_line,
                       report::StagedFolder& folder) {
  explanation_page(explanation, command_line).write(folder.path() / "report.html");
  folder.write("explanation.json", explanation_json(explanation));
  folder.publish({"report.html", "explanation.json"});
}

}  // namespace stillhand::study
