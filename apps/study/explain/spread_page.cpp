// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "apps/libraries/report/text/text.hpp"
#include "apps/study/explain/explanation_output.hpp"
#include "services/core/statistics/distributions.hpp"

namespace stillhand::study {
namespace {

using report::Cell;
using report::number;
using report::short_number;

constexpr std::array<const char*, 3> kMetricNames{"RMS error [mm]", "dwell ratio", "f_c [Hz]"};
// More people than anybody studies.
constexpr double kMostPeople = 1000.0;

std::string three(const auto& values, std::size_t first, int decimals = 2) {
  return fmt::format("{:.{}f}, {:.{}f}, {:.{}f}", values[first], decimals, values[first + 1],
                     decimals, values[first + 2], decimals);
}

std::string z_of(const SpreadFit& fit) {
  return fmt::format("{:.1f}, {:.1f}, {:.1f}", fit.z[6], fit.z[7], fit.z[8]);
}

std::string values_of(const SpreadFit& fit) {
  std::string out;
  for (const auto& [c, value] : fit.causes) {
    const Cause& cause = spread_causes()[c];
    out += fmt::format("{}{} {}", out.empty() ? "" : ", ", cause.parameter, short_number(value));
  }
  return out;
}

// The deviation of n normal values over that of all people: what n people leave open.
std::array<double, 2> chi_square_interval(double deviation, int people) {
  const auto end = [&](double p) {
    return deviation *
           std::sqrt((people - 1.0) / statistics::chi_squared_quantile(p, people - 1.0));
  };
  return {end(0.975), end(0.025)};
}

report::Table state_table(const Spread& spread) {
  report::Table table;
  table.caption =
      "Standard deviations of B-C between people. The paper's follow from its p-values. Interval: "
      "95 %, of a deviation of twelve (chi square), of a ratio of both (F).";
  table.header = {"metric", "paper", "paper's interval", "chain", "chain over paper", "interval"};
  const SpreadJudged& chain = spread.judged.front();
  for (std::size_t k = 0; k < 3; ++k) {
    const double paper = spread.paper[3 + k];
    const auto open = chi_square_interval(paper, kPaperSubjects);
    const auto& ratio = chain.ratio_ci95[3 + k];
    table.rows.push_back({kMetricNames[k], short_number(paper),
                          short_number(open[0]) + " to " + short_number(open[1]),
                          short_number(chain.fit.over_paper[3 + k] * paper),
                          number(chain.fit.over_paper[3 + k], 2),
                          number(ratio[0], 2) + " to " + number(ratio[1], 2)});
  }
  return table;
}

report::Table ranking_table(const Spread& spread) {
  report::Table table;
  table.caption =
      "What each cause adds to the chain, where it gives most of the missing deviation of B-C "
      "while "
      "the means of B-C stay within a standard error of the paper's and those of A and A-B within "
      "one of the chain's. Three figures: RMS error, dwell ratio, f_c. Deviations over the "
      "paper's. "
      "At the end of the range the means may be off.";
  table.header = {"cause",      "parameter",  "given [95 %]",     "z of B-C means", "SDs of A-B",
                  "SDs of B-C", "at the end", "SDs of B-C there", "means there"};
  table.align = std::vector(9, report::Align::kLeft);
  const auto row = [&](const SpreadFit& fit) {
    return std::vector<Cell>{fit.name,
                             values_of(fit),
                             fmt::format("{:.0f} % [{:.0f}, {:.0f}]", 100.0 * fit.given,
                                         100.0 * fit.low, 100.0 * fit.high),
                             z_of(fit),
                             three(fit.over_paper, 0),
                             three(fit.over_paper, 3)};
  };
  table.rows.push_back(row(spread.chain));
  for (const SpreadFit& fit : spread.ranked) {
    table.rows.push_back(row(fit));
    const SpreadFit& end = spread.ends[fit.causes.front().first];
    table.rows.back().insert(table.rows.back().end(),
                             {short_number(end.causes.front().second), three(end.over_paper, 3),
                              end.holds ? "hold" : "z " + z_of(end)});
  }
  return table;
}

report::Table judged_table(const Spread& spread) {
  report::Table table;
  table.caption = fmt::format(
      "The same on {} other people (seed {}), simulated directly. Nothing was chosen on them.",
      spread.subjects, spread.judged_seed);
  table.header = {"cause",      "parameter",  "z of B-C means",    "z of C means",
                  "SDs of A-B", "SDs of B-C", "interval of these", "given"};
  table.align = std::vector(8, report::Align::kLeft);
  for (const SpreadJudged& one : spread.judged) {
    std::string intervals;
    for (std::size_t k = 3; k < 6; ++k) {
      intervals += fmt::format("{}[{:.2f}, {:.2f}]", k > 3 ? " " : "", one.ratio_ci95[k][0],
                               one.ratio_ci95[k][1]);
    }
    table.rows.push_back({one.fit.name, values_of(one.fit), z_of(one.fit),
                          three(one.fit.z_of_c, 0, 1), three(one.fit.over_paper, 0),
                          three(one.fit.over_paper, 3), intervals,
                          number(100.0 * one.fit.given, 0) + " %"});
  }
  return table;
}

std::string people(const std::pair<std::size_t, double>& best) {
  if (best.second > kMostPeople) return "more than 1000";
  return fmt::format("{:.0f}, {}", std::ceil(best.second), kSignatures[best.first].name);
}

report::Table signature_table(const Spread& spread) {
  report::Table table;
  table.caption =
      "What a laboratory would measure if each person tracked B and C twice with one model, over "
      "the same people: correlations between people, then deviations.";
  table.header = {"signature"};
  for (const SpreadJudged& one : spread.judged) table.header.push_back(one.fit.name);
  for (std::size_t s = 0; s < kSignatures.size(); ++s) {
    std::vector<Cell> row{kSignatures[s].name};
    for (const SpreadJudged& one : spread.judged) row.emplace_back(number(one.signatures[s], 2));
    table.rows.push_back(std::move(row));
  }
  return table;
}

report::Table people_table(const Spread& spread) {
  report::Table table;
  table.caption =
      "People for whom the best signature is unlike the chain's, in four studies of five at a "
      "level of 0.05.";
  table.header = {"cause", "from the chain"};
  table.align = std::vector(2, report::Align::kLeft);
  for (std::size_t i = 1; i < spread.judged.size(); ++i) {
    const SpreadJudged& one = spread.judged[i];
    table.rows.push_back(
        {one.fit.name, people(tells_apart(one.signatures, spread.judged.front().signatures))});
  }
  return table;
}

}  // namespace

void add_spread(report::Page& page, const Spread& spread) {
  page.section("The second residual: how much people differ");
  page.paragraph(
      "With the paper's chain the means of C are the paper's, but the simulated people are too "
      "much "
      "alike. Here each cause acts in addition to the chain, in every trial with a rig of its "
      "own.");
  page.table(state_table(spread));
  page.table(ranking_table(spread));
  page.section("Judged on other people", 3);
  page.table(judged_table(spread));
  page.section("What a laboratory could tell apart", 3);
  page.table(signature_table(spread));
  page.table(people_table(spread));
  page.section("The causes of spread", 3);
  page.table(causes_table(spread_causes()));
}

}  // namespace stillhand::study
