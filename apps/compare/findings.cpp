// SPDX-License-Identifier: Apache-2.0
#include "apps/compare/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/libraries/report/or_null.hpp"

namespace stillhand::compare {
namespace {

using nlohmann::ordered_json;

std::string with_unit(double value, const Number& metric) {
  return metric.unit() == "-" ? fmt::format("{:.3g}", value)
                              : fmt::format("{:.3g} {}", value, metric.unit());
}

std::string p_text(double p) { return p < 1e-3 ? "p < 0.001" : fmt::format("p = {:.2g}", p); }

std::string percent(double share) { return fmt::format("{:.0f}", 100.0 * share); }

std::string people_text(std::size_t count) {
  return count == 1 ? "one person" : fmt::format("{} people", count);
}

// What the best option does, and to whom.
std::string best_sentence(const Comparison& all, std::size_t m, std::size_t best) {
  const Number& metric = kMetrics[m];
  const Outcome& outcome = all.options[best].outcomes[m];
  std::string text =
      fmt::format("For the {}, {} is the best on average ({}, {})", metric.judged,
                  name_of(all, best), with_unit(outcome.mean, metric), people_text(outcome.people));
  if (outcome.restored.share)
    text += fmt::format("; it restores {} %", percent(*outcome.restored.share));
  if (outcome.restored.interval) {
    text += fmt::format(" ({} to {} %) of the loss through motion",
                        percent(outcome.restored.interval->low),
                        percent(outcome.restored.interval->high));
  }
  if (outcome.harmed) {
    text += fmt::format("; {} of {} are worse off with it than without", *outcome.harmed,
                        outcome.compared);
  }
  return text + ".";
}

// How sure that is.
std::string sure_sentence(const Comparison& all, std::size_t m) {
  const Ranking& ranking = all.rankings[m];
  const auto with_values = std::ranges::count_if(
      all.options, [m](const Option& option) { return option.outcomes[m].people > 0; });
  if (with_values < 2) return "No other option has a value of it.";
  if (ranking.contrasts.empty()) {
    return all.options[*ranking.best].outcomes[m].people < 2
               ? "With one person in an option, this says nothing about other people."
               : "No other option can be tested against it: there is one person, or the values are "
                 "equal.";
  }
  std::string names;
  for (const std::size_t other : ranking.as_good) {
    names += (names.empty() ? "" : "; ") + name_of(all, other);
  }
  if (!names.empty()) return "These data do not separate it from: " + names + ".";
  const auto closest = std::ranges::min_element(ranking.contrasts, {}, &Contrast::better_by);
  return fmt::format(
      "It is better than every other option. The next is {}: the difference is {} ({} to {}), {} "
      "after Holm, {}.",
      name_of(all, closest->other), with_unit(closest->better_by, kMetrics[m]),
      number(closest->low), number(closest->high), p_text(closest->p),
      closest->same_people ? "the same people" : "different people");
}

ordered_json outcome_json(const Outcome& outcome) {
  using report::or_null;
  ordered_json out;
  out["people"] = outcome.people;
  out["mean"] = outcome.people > 0 ? ordered_json(outcome.mean) : ordered_json(nullptr);
  out["ci95"] = or_null(outcome.interval);
  out["restored"] = or_null(outcome.restored.share);
  out["restored_ci95"] = or_null(outcome.restored.interval);
  out["compared"] = outcome.compared;
  out["harmed"] = or_null(outcome.harmed);
  out["least_gain"] = or_null(outcome.least_gain);
  return out;
}

ordered_json ranking_json(const Comparison& all, const Ranking& ranking) {
  ordered_json out;
  out["best"] = ranking.best ? ordered_json(name_of(all, *ranking.best)) : ordered_json(nullptr);
  out["as_good"] = ordered_json::array();
  for (const std::size_t other : ranking.as_good) out["as_good"].push_back(name_of(all, other));
  out["better_than"] = ordered_json::array();
  for (const Contrast& contrast : ranking.contrasts) {
    out["better_than"].push_back({{"option", name_of(all, contrast.other)},
                                  {"same_people", contrast.same_people},
                                  {"by", contrast.better_by},
                                  {"ci95", {contrast.low, contrast.high}},
                                  {"p_holm", contrast.p}});
  }
  return out;
}

}  // namespace

std::string number(double value) { return fmt::format("{:.3g}", value); }

std::string name_of(const Comparison& all, std::size_t option) {
  const Option& named = all.options[option];
  return all.sides[named.side].name + ", " + named.condition;
}

std::vector<std::string> findings(const Comparison& all) {
  std::vector<std::string> out;
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    const Ranking& ranking = all.rankings[m];
    if (!ranking.best) continue;
    out.push_back(best_sentence(all, m, *ranking.best) + " " + sure_sentence(all, m));
  }
  return out;
}

report::Table options_table(const Comparison& all) {
  report::Table table{"Mean of each option, and how much of the loss through motion it restores",
                      {"option"}};
  for (const Number& metric : kMetrics) table.header.emplace_back(metric.judged);
  for (std::size_t i = 0; i < all.options.size(); ++i) {
    std::vector<report::Cell> row{name_of(all, i)};
    for (std::size_t m = 0; m < kMetrics.size(); ++m) {
      const Outcome& outcome = all.options[i].outcomes[m];
      std::string cell = outcome.people == 0 ? "–" : with_unit(outcome.mean, kMetrics[m]);
      if (outcome.restored.share) cell += fmt::format(" ({} %)", percent(*outcome.restored.share));
      row.emplace_back(cell);
    }
    table.rows.push_back(row);
  }
  return table;
}

std::string comparison_json(const Comparison& all) {
  ordered_json json;
  json["options"] = ordered_json::array();
  for (std::size_t i = 0; i < all.options.size(); ++i) {
    const Option& option = all.options[i];
    ordered_json one{{"name", name_of(all, i)},
                     {"side", all.sides[option.side].name},
                     {"condition", option.condition}};
    for (std::size_t m = 0; m < kMetrics.size(); ++m) {
      one[kMetrics[m].key] = outcome_json(option.outcomes[m]);
    }
    json["options"].push_back(std::move(one));
  }
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    json["rankings"][kMetrics[m].key] = ranking_json(all, all.rankings[m]);
  }
  json["findings"] = findings(all);
  return json.dump(2) + '\n';
}

}  // namespace stillhand::compare
