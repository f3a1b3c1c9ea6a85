// SPDX-License-Identifier: Apache-2.0
#include "apps/compare/core/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

#include "services/core/contract/config_error.hpp"
#include "services/core/statistics/multiple_testing.hpp"
#include "services/core/statistics/t_test.hpp"

namespace stillhand::compare {
namespace {

constexpr double kSignificant = 0.05;

std::vector<double> known(const std::vector<double>& values) {
  std::vector<double> out;
  std::ranges::copy_if(values, std::back_inserter(out), [](double x) { return std::isfinite(x); });
  return out;
}

/// Pairs of which both are known.
std::pair<std::vector<double>, std::vector<double>> pairs(const std::vector<double>& a,
                                                          const std::vector<double>& b) {
  std::pair<std::vector<double>, std::vector<double>> out;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (!std::isfinite(a[i] + b[i])) continue;
    out.first.push_back(a[i]);
    out.second.push_back(b[i]);
  }
  return out;
}

/// Gain of each person over B, + better.
std::vector<double> gains(const Number& metric, const std::vector<double>& moving,
                          const std::vector<double>& with) {
  const double sign = metric.lower_is_better ? 1.0 : -1.0;
  std::vector<double> out(std::min(moving.size(), with.size()));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = sign * (moving[i] - with[i]);
  return out;
}

Outcome outcome_of(const Side& side, const Condition& condition, std::size_t m) {
  Outcome out;
  const std::vector<double> values = known(condition.values[m]);
  out.people = values.size();
  if (values.empty()) return out;
  out.mean = statistics::mean(values);
  if (values.size() > 1) out.interval = statistics::mean_interval(values);
  const Condition* moving = side.find("B");
  if (moving == nullptr) return out;
  const auto gained = known(gains(kMetrics[m], moving->values[m], condition.values[m]));
  if (gained.empty()) return out;
  out.compared = gained.size();
  out.least_gain = *std::ranges::min_element(gained);
  out.harmed = static_cast<std::size_t>(
      std::ranges::count_if(gained, [](double gain) { return gain < 0.0; }));
  const Condition* still = side.find("A");
  if (still == nullptr) return out;
  const auto lost = known(gains(kMetrics[m], moving->values[m], still->values[m]));
  if (!lost.empty() && statistics::mean(lost) > 0.0) {
    out.restored =
        statistics::restored_share(still->values[m], moving->values[m], condition.values[m]);
  }
  return out;
}

const std::vector<double>& values_of(const Comparison& all, const Option& option, std::size_t m) {
  return all.sides[option.side].find(option.condition)->values[m];
}

// Eq. CO-2 without Holm; nothing where it cannot be tested.
std::optional<Contrast> contrast_of(const Comparison& all, std::size_t best, std::size_t other,
                                    std::size_t m) {
  const Option& first = all.options[best];
  const Option& second = all.options[other];
  const double sign = kMetrics[m].lower_is_better ? -1.0 : 1.0;
  Contrast out;
  out.other = other;
  out.same_people = same_people(all.sides[first.side], all.sides[second.side]);
  try {
    if (out.same_people) {
      const auto [x, y] = pairs(values_of(all, first, m), values_of(all, second, m));
      const auto test = statistics::paired_t_test(x, y);
      out = {other, true, test.mean_difference, test.ci_low, test.ci_high, test.p};
    } else {
      const auto test = statistics::welch_t_test(known(values_of(all, first, m)),
                                                 known(values_of(all, second, m)));
      out = {other, false, test.mean_difference, test.ci_low, test.ci_high, test.p};
    }
  } catch (const ConfigError&) {
    return std::nullopt;  // one person, or no difference at all
  }
  out.better_by *= sign;
  if (sign < 0.0) std::tie(out.low, out.high) = std::pair(-out.high, -out.low);
  return out;
}

Ranking ranking_of(const Comparison& all, std::size_t m) {
  Ranking out;
  for (std::size_t i = 0; i < all.options.size(); ++i) {
    const Outcome& outcome = all.options[i].outcomes[m];
    if (outcome.people == 0) continue;
    const auto better = [&](double mean) {
      return kMetrics[m].lower_is_better ? outcome.mean < mean : outcome.mean > mean;
    };
    if (!out.best || better(all.options[*out.best].outcomes[m].mean)) out.best = i;
  }
  if (!out.best) return out;
  std::vector<double> p;
  for (std::size_t i = 0; i < all.options.size(); ++i) {
    if (i == *out.best || all.options[i].outcomes[m].people == 0) continue;
    if (const auto contrast = contrast_of(all, *out.best, i, m)) {
      p.push_back(contrast->p);
      out.contrasts.push_back(*contrast);
    } else {
      out.as_good.push_back(i);
    }
  }
  if (!p.empty()) p = statistics::holm_adjusted(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    out.contrasts[i].p = p[i];
    if (p[i] >= kSignificant) out.as_good.push_back(out.contrasts[i].other);
  }
  std::ranges::sort(out.as_good);
  return out;
}

}  // namespace

const Condition* Side::find(const std::string& label) const noexcept {
  const auto found = std::ranges::find(conditions, label, &Condition::label);
  return found == conditions.end() ? nullptr : &*found;
}

bool same_people(const Side& first, const Side& second) noexcept {
  if (&first == &second) return true;
  const Condition* a = first.find("A");
  const Condition* b = second.find("A");
  if (a == nullptr || b == nullptr || a->values[0].size() != b->values[0].size()) return false;
  std::size_t same = 0;
  for (std::size_t i = 0; i < a->values[0].size(); ++i) same += a->values[0][i] == b->values[0][i];
  return same > 0 && 2 * same >= a->values[0].size();
}

Comparison compared(std::vector<Side> sides) {
  Comparison out;
  out.sides = std::move(sides);
  for (std::size_t s = 0; s < out.sides.size(); ++s) {
    for (const Condition& condition : out.sides[s].conditions) {
      if (condition.label == "A" || condition.label == "B") continue;
      Option option{.side = s, .condition = condition.label, .outcomes = {}};
      for (std::size_t m = 0; m < kMetrics.size(); ++m) {
        option.outcomes[m] = outcome_of(out.sides[s], condition, m);
      }
      out.options.push_back(std::move(option));
    }
  }
  for (std::size_t m = 0; m < kMetrics.size(); ++m) out.rankings[m] = ranking_of(out, m);
  return out;
}

}  // namespace stillhand::compare
