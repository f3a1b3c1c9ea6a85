// SPDX-License-Identifier: Apache-2.0
// Report: what an experiment registered, and how many participants the next one needs.
#include <fmt/format.h>

#include <algorithm>

#include "apps/libraries/report/text/text.hpp"
#include "apps/study/report/report_cells.hpp"
#include "apps/study/report/report_sections.hpp"

namespace stillhand::study {
namespace {

using report::Cell;
using report::Emphasis;
using report::number;
using report::short_number;
using session::kMetrics;

// Change with its interval, and the p of Holm, of one test as two cells.
// @param planned  or nullptr
void add_test(std::vector<Cell>& row, const PlannedComparison* planned, std::size_t metric,
              double alpha) {
  if (planned == nullptr || !planned->comparison.tests[metric]) {
    row.insert(row.end(), 2, Cell("–"));
    return;
  }
  const auto& test = planned->comparison.tests[metric];
  row.emplace_back(fmt::format("{} [{}, {}]", number(test->mean_difference, decimals(metric)),
                               number(test->ci_low, decimals(metric)),
                               number(test->ci_high, decimals(metric))));
  const double holm = *planned->p_holm[metric];
  row.emplace_back(p_value(holm), holm < alpha ? Emphasis::kStrong : Emphasis::kNone);
}

report::Table comparisons_table(const Registered& registered) {
  const double alpha = registered.registration.alpha;
  report::Table table;
  table.caption = fmt::format(
      "Planned comparisons with the exclusion rules ({} participants) and without them ({}). "
      "Holm's p is over all planned comparisons and metrics together; strong: below {}.",
      registered.planned.empty() || !registered.planned.front().comparison.tests[0]
          ? std::string("–")
          : std::to_string(registered.planned.front().comparison.tests[0]->n),
      registered.without.participants.size(), short_number(alpha));
  table.header = {"comparison", "metric",        "change [95 % CI]",
                  "p (Holm)",   "without rules", "p (Holm)"};
  for (const PlannedComparison& without : registered.planned_without) {
    const Comparison& comparison = without.comparison;
    // The rules may leave nobody in one of the two conditions.
    const auto with = std::ranges::find_if(registered.planned, [&](const PlannedComparison& each) {
      return each.comparison.from == comparison.from && each.comparison.to == comparison.to;
    });
    for (std::size_t k = 0; k < kMetricCount; ++k) {
      std::vector<Cell> row{pair_word(comparison.from, comparison.to), kMetrics[k].title};
      add_test(row, with == registered.planned.end() ? nullptr : &*with, k, alpha);
      add_test(row, &without, k, alpha);
      table.rows.push_back(row);
    }
  }
  return table;
}

report::Table needed_table(const StudyRecord& record) {
  report::Table table;
  table.caption = fmt::format(
      "Participants that a paired t-test at α = {} needs. \"Observed\" is the effect of these data "
      "(Hedges' g_z), which is uncertain itself.",
      short_number(alpha_of(record)));
  table.header = {"comparison", "metric", "effect", "d_z", "for power 0.8", "for power 0.9"};
  for (const Needed& needed : record.needed) {
    std::vector<Cell> row{needed.comparison, kMetrics[needed.metric].title, needed.effect,
                          number(needed.effect_dz, 2)};
    for (const Needed::At& at : needed.at) row.emplace_back(std::to_string(at.participants));
    if (needed.at.empty()) row.insert(row.end(), 2, Cell("–"));
    table.rows.push_back(row);
  }
  return table;
}

}  // namespace

void add_registered(report::Page& page, const StudyRecord& record) {
  if (record.recorded && record.recorded->registered) {
    const Registered& registered = *record.recorded->registered;
    page.section("Pre-registered analysis");
    if (registered.excluded.empty()) {
      page.paragraph("The exclusion rules of experiment.yaml exclude no participant and no trial.");
    } else {
      page.paragraph(
          "The exclusion rules of experiment.yaml take the following out of all other tables and "
          "figures.");
      page.list(registered.excluded);
    }
    const auto tested = [](const auto& all) {
      return std::ranges::any_of(
          all, [](const PlannedComparison& each) { return has_test(each.comparison); });
    };
    if (tested(registered.planned) || tested(registered.planned_without)) {
      page.table(comparisons_table(registered));
    } else {
      page.paragraph("No planned comparison can be tested with so few participants.");
    }
  }
  if (record.plan_dz) {
    page.section("The next study");
    if (record.needed.empty()) {
      page.paragraph("Without a test there is no effect to plan the next study with.");
    } else {
      page.table(needed_table(record));
    }
  }
}

}  // namespace stillhand::study
